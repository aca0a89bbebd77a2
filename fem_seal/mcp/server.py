"""The server of `fem-seal mcp`: its tools, and the process that calculates for them."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures.process import BrokenProcessPool
from dataclasses import asdict
from functools import partial
from inspect import Parameter, Signature, signature
from multiprocessing import Pipe
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated, Any, Literal

import anyio
import anyio.to_thread
from mcp.server.mcpserver import Context, Image, MCPServer
from mcp.types import CallToolResult, TextContent, ToolAnnotations
from pydantic import Field

from fem_seal.errors import InputError
from fem_seal.files import as_json, own_tables, problem
from fem_seal.mcp import manual, work
from fem_seal.mcp.folder import Folder, folder_at
from fem_seal.mcp.work import Reply
from fem_seal.processes import Processes, usable_memory
from fem_seal.version import __version__

# So often it is looked whether a process has something to say [s], and what it may take of the machine's memory.
_LOOK, _MEMORY = 0.05, 0.6
_INSTRUCTIONS = """\
Leak rates of metal seals (valve seats, solid metal gaskets) from a case: one TOML file with shapes, materials,
roughness, fluid and loads; quantities are texts with units. Begin with new_case, change its TOML, then check_case and
run_case. Pass a case as the path of a file in the folder (case_path) or as its text (case_toml). Never claim more than
the answer: tell the interval and the validity with every leak rate, and say "outside the theory" where it stands."""


def serve(path: Path, time_limit: float) -> None:
    """Answer over standard input and output until it is closed.

    Parameters
    ----------
    path : Path
        The folder outside of which nothing is read or written.
    time_limit : float
        Of one answer [s].
    """
    folder = folder_at(path)
    with TemporaryDirectory(prefix=".fem-seal-", dir=folder.root) as drafts:
        worker = Worker(folder, drafts, time_limit)
        try:
            server_of(worker).run("stdio")
        finally:
            worker.end()


class Worker:
    """A process that calculates one answer after the other; it is ended with one that is cancelled or takes too long.

    Parameters
    ----------
    folder : Folder
    drafts : str
        A folder in it for what is written meanwhile.
    time_limit : float
        Of one answer [s].
    """

    def __init__(self, folder: Folder, drafts: str, time_limit: float) -> None:
        self._folder, self._drafts, self._time_limit = folder, drafts, time_limit
        self._turn = anyio.Lock()
        self._processes: Processes | None = None

    async def ask(self, context: Context, tool: str, **arguments: Any) -> CallToolResult:
        """What a tool answers."""
        async with self._turn:
            try:
                with anyio.fail_after(self._time_limit):
                    return _as_result(await self._reply(context, tool, arguments))
            except TimeoutError:
                refusal = problem("mcp_time", limit=self._time_limit / 60)
            except BrokenProcessPool:
                refusal = problem("mcp_died", memory=_MEMORY * usable_memory() / 2**30)
            return _as_result(Reply({"refused": str(refusal), **arguments}, refused=True))

    async def _reply(self, context: Context, tool: str, arguments: dict[str, Any]) -> Reply:
        done = False
        try:
            # the first call loads everything, which takes some seconds
            future = await anyio.to_thread.run_sync(partial(self._submit, tool, arguments))
            count = 0
            while not done:
                await anyio.sleep(_LOOK)
                done = future.done()
                while self._heard.poll():
                    count += 1
                    await context.report_progress(count, message=self._heard.recv())
            return future.result()
        finally:
            if not done or future.exception() is not None:
                self.end()

    def _submit(self, tool: str, arguments: dict[str, Any]) -> Any:
        if self._processes is None:
            self._heard, told = Pipe(duplex=False)
            self._processes = Processes(
                1,
                work.begin,
                self._folder.root,
                self._drafts,
                told,
                memory=_MEMORY * usable_memory(),
                preload=["fem_seal.mcp.work", "fem_seal.result", "fem_seal.output.files"],
            )
        return self._processes.submit(work.answer, tool, self._folder.root, arguments)

    def end(self) -> None:
        """End the process, whatever it is doing; the next call starts another one."""
        if self._processes is not None:
            self._processes.end()
        self._processes = None


def _as_result(reply: Reply) -> CallToolResult:
    text = TextContent(type="text", text=as_json(reply.says))
    pictures = [Image(data=data, format="png").to_image_content() for data in reply.pictures]
    return CallToolResult(content=[text, *pictures], structured_content=reply.says, is_error=reply.refused)


def _looked_up(look: Callable[[], list[manual.Entry]], after: str) -> CallToolResult:
    try:
        found = [asdict(entry) for entry in look()]
        other = ("search_manual", "nothing is found: with other words, such as roughness or leak rate")
        tool, why = (after, "to use it") if found else other
        return _as_result(Reply({"found": found, "next": {"tool": tool, "why": why}}))
    except InputError as error:
        return _as_result(Reply({"refused": str(error)}, refused=True))


class _Server(MCPServer):
    """Refuses what a tool has no argument for, instead of answering as if it had not been given."""

    async def call_tool(self, name: str, arguments: dict[str, Any], context: Any = None) -> Any:
        known = {tool.name: list(tool.input_schema["properties"]) for tool in await self.list_tools()}
        unknown = [key for key in arguments if key not in known.get(name, arguments)]
        if unknown:
            refusal = problem("mcp_argument", key=unknown[0], tool=name, known=", ".join(known[name]))
            return _as_result(Reply({"refused": str(refusal)}, refused=True))
        return await super().call_tool(name, arguments, context)


def server_of(worker: Worker) -> MCPServer:
    """The server with its tools.

    Parameters
    ----------
    worker : Worker
    """
    server = _Server("fem-seal", version=__version__, instructions=_INSTRUCTIONS, log_level="WARNING")
    for name, tool in work.TOOLS.items():
        # nothing is written over, whatever is asked
        hints = ToolAnnotations(read_only_hint=tool is work.check_case, destructive_hint=False)
        server.add_tool(_asking(worker, name, tool), name, description=tool.__doc__, annotations=hints)
    looks = ToolAnnotations(read_only_hint=True)

    @server.tool(annotations=looks)
    def explain(kind: Literal["validity", "column", "key"], name: str) -> CallToolResult:
        """What a key of the case, a column of the results, or a reason under validity means."""
        return _looked_up(partial(manual.explain, kind, name), "check_case")

    @server.tool(annotations=looks)
    def search_manual(words: str) -> CallToolResult:
        """Keys, columns, findings, messages, templates, materials and fluids that fit some words."""
        return _looked_up(partial(manual.search, words), "explain")

    return server


def _asking(worker: Worker, name: str, tool: Callable[..., Reply]) -> Callable[..., Any]:
    """A function with the arguments of a tool, and what is said of them, that has the other process answer."""

    async def ask(context: Context, **arguments: Any) -> CallToolResult:
        return await worker.ask(context, name, **arguments)

    given = signature(tool, eval_str=True)
    words = own_tables("options.toml")["assistant"]
    arguments = {
        key: each.replace(annotation=Annotated[each.annotation, Field(description=words[key])])
        for key, each in given.parameters.items()
        if key != "folder"
    }
    context = Parameter("context", Parameter.POSITIONAL_OR_KEYWORD, annotation=Context)
    ask.__signature__ = Signature([context, *arguments.values()], return_annotation=CallToolResult)  # type: ignore[attr-defined]
    ask.__annotations__ |= {key: each.annotation for key, each in arguments.items()}
    return ask

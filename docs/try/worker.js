// A Python with NumPy and SciPy, compiled to WebAssembly, as a thread of the page: the few calls of WASI that it makes.
// It sees read-only files alone, those of `files`, and writes to the page alone.
const FAILED = 52, NO_FILE = 44, BAD = 8;
const text = new TextDecoder(), bytes = new TextEncoder();
let exports_, printed = "", failed = "";
const files = new Map(), open = new Map();
const memory = () => new DataView(exports_.memory.buffer);
const place = (start, length) => new Uint8Array(exports_.memory.buffer, start, length);

const folder = (path) => [...files.keys()].some((name) => name.startsWith(path + "/"));
const inside = (path) =>
  [...new Set([...files.keys()].filter((name) => name.startsWith(path + "/")).map((name) => name.slice(path.length + 1).split("/")[0]))];
const resolved = (fd, start, length) => (open.get(fd).path + "/" + text.decode(place(start, length))).replace(/\/\.?(?=\/|$)/g, "");

function stat(path, into) {
  const data = files.get(path);
  if (!data && !folder(path)) return NO_FILE;
  place(into, 64).fill(0);
  memory().setBigUint64(into + 8, BigInt([...path].reduce((sum, one) => (sum * 31 + one.charCodeAt(0)) >>> 0, 7)), true);
  memory().setUint8(into + 16, data ? 4 : 3);
  memory().setBigUint64(into + 32, BigInt(data ? data.length : 0), true);
  return 0;
}

function each(vectors, count, handle) {
  let total = 0;
  for (let n = 0; n < count; n++)
    total += handle(memory().getUint32(vectors + 8 * n, true), memory().getUint32(vectors + 8 * n + 4, true));
  return total;
}

function read(fd, vectors, count, offset, into) {
  const file = open.get(fd), data = file && files.get(file.path);
  if (!data) { memory().setUint32(into, 0, true); return fd === 0 ? 0 : BAD; }
  let at = offset ?? file.at;
  memory().setUint32(into, each(vectors, count, (start, length) => {
    const part = data.subarray(at, at + length);
    place(start, part.length).set(part);
    at += part.length;
    return part.length;
  }), true);
  if (offset === undefined) file.at = at;
  return 0;
}

const strings = (list) => ({
  sizes: (count, size) => {
    memory().setUint32(count, list.length, true);
    memory().setUint32(size, list.reduce((sum, one) => sum + bytes.encode(one).length + 1, 0), true);
    return 0;
  },
  get: (pointers, buffer) => {
    for (const one of list) {
      const data = bytes.encode(one + "\0");
      memory().setUint32(pointers, buffer, true);
      place(buffer, data.length).set(data);
      pointers += 4;
      buffer += data.length;
    }
    return 0;
  },
});
const args = strings(["python"]), environ = strings(["PYTHONTZPATH=", "HOME=/tmp", "TMPDIR=/tmp"]);

const wasi = {
  args_sizes_get: args.sizes, args_get: args.get, environ_sizes_get: environ.sizes, environ_get: environ.get,
  clock_res_get: (id, into) => (memory().setBigUint64(into, 1000n, true), 0),
  clock_time_get: (id, precision, into) =>
    (memory().setBigUint64(into, BigInt(Math.round((id ? performance.now() : Date.now()) * 1e6)), true), 0),
  random_get: (start, length) => {
    for (let n = 0; n < length; n += 65536) crypto.getRandomValues(place(start + n, Math.min(65536, length - n)));
    return 0;
  },
  sched_yield: () => 0,
  proc_exit: (code) => { throw new Error("Python has ended: " + code); },
  fd_prestat_get: (fd, into) => {
    if (!open.get(fd)?.given) return BAD;
    memory().setUint32(into, 0, true);
    memory().setUint32(into + 4, open.get(fd).path.length, true);
    return 0;
  },
  fd_prestat_dir_name: (fd, start, length) => (place(start, length).set(bytes.encode(open.get(fd).path)), 0),
  fd_fdstat_get: (fd, into) => {
    if (fd > 2 && !open.has(fd)) return BAD;
    place(into, 24).fill(0);
    memory().setUint8(into, fd < 3 ? 2 : files.has(open.get(fd).path) ? 4 : 3);
    memory().setBigUint64(into + 8, 0x1fffffffn, true);
    memory().setBigUint64(into + 16, 0x1fffffffn, true);
    return 0;
  },
  fd_fdstat_set_flags: () => 0,
  fd_filestat_get: (fd, into) => {
    if (open.has(fd)) return stat(open.get(fd).path, into);
    if (fd > 2) return BAD;
    place(into, 64).fill(0);
    memory().setUint8(into + 16, 2);
    return 0;
  },
  fd_close: (fd) => (open.delete(fd), 0),
  fd_read: (fd, vectors, count, into) => read(fd, vectors, count, undefined, into),
  fd_pread: (fd, vectors, count, offset, into) => read(fd, vectors, count, Number(offset), into),
  fd_seek: (fd, offset, whence, into) => {
    const file = open.get(fd);
    if (!file) return fd < 3 ? 70 : BAD;
    file.at = [0, file.at, files.get(file.path)?.length ?? 0][whence] + Number(offset);
    memory().setBigUint64(into, BigInt(file.at), true);
    return 0;
  },
  fd_tell: (fd, into) => (memory().setBigUint64(into, BigInt(open.get(fd)?.at ?? 0), true), 0),
  fd_write: (fd, vectors, count, into) => {
    memory().setUint32(into, each(vectors, count, (start, length) => {
      const told = text.decode(place(start, length).slice());
      if (fd === 1) printed += told; else failed += told;
      return length;
    }), true);
    const lines = printed.split("\n");
    printed = lines.pop();
    for (const line of lines) postMessage({ line });
    return 0;
  },
  fd_readdir: (fd, start, length, cookie, into) => {
    const names = inside(open.get(fd).path);
    let used = 0;
    for (let n = Number(cookie); n < names.length && used < length; n++) {
      const name = bytes.encode(names[n]), entry = new Uint8Array(24 + name.length), view = new DataView(entry.buffer);
      view.setBigUint64(0, BigInt(n + 1), true);
      view.setUint32(16, name.length, true);
      view.setUint8(20, files.has(open.get(fd).path + "/" + names[n]) ? 4 : 3);
      entry.set(name, 24);
      const part = entry.subarray(0, length - used);
      place(start + used, part.length).set(part);
      used += part.length;
    }
    memory().setUint32(into, used, true);
    return 0;
  },
  path_filestat_get: (fd, flags, start, length, into) => stat(resolved(fd, start, length), into),
  path_open: (fd, flags, start, length, oflags, rights, inheriting, fdflags, into) => {
    const path = resolved(fd, start, length);
    if (!files.has(path) && !folder(path)) return NO_FILE;
    const number = Math.max(...open.keys()) + 1;
    open.set(number, { path, at: 0 });
    memory().setUint32(into, number, true);
    return 0;
  },
};

function run(code) {
  failed = "";
  const data = bytes.encode(code), start = exports_.host_alloc(data.length) >>> 0;
  place(start, data.length).set(data);
  if (exports_.turn(start, data.length) !== 0) throw new Error(failed);
}

async function begin() {
  const got = async (name) => new Uint8Array(await (await fetch(name)).arrayBuffer());
  const [module, library, sources] = await Promise.all([
    WebAssembly.compileStreaming(fetch("python.wasm")), got("python-stdlib.zip"), fetch("sources.json").then((one) => one.json()),
  ]);
  files.set("/usr/local/lib/python315.zip", library);
  for (const [name, source] of Object.entries(sources)) files.set("/usr/local/lib/site/" + name, bytes.encode(source));
  open.set(3, { path: "/usr/local/lib", given: true, at: 0 });
  const other = new Proxy(wasi, { get: (all, name) => all[name] ?? (() => FAILED) });
  const imports = { wasi_snapshot_preview1: other, host: { call: () => -1 } };
  exports_ = (await WebAssembly.instantiate(module, imports)).exports;
  exports_._initialize?.();
  run("import sys; sys.path.append('/usr/local/lib/site'); import json, seal; print(json.dumps(seal.choices()))");
}

onmessage = async ({ data }) => {
  try {
    if (data === "begin") await begin();
    else run(`seal.main(${JSON.stringify(JSON.stringify(data))})`);
    postMessage({ done: true });
  } catch (error) {
    postMessage({ error: String(error.message ?? error) });
  }
};

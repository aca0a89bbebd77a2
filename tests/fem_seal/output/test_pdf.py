"""The report on paper and on dark screens."""

from __future__ import annotations

import subprocess
from types import SimpleNamespace

import pytest
from sample_results import rough_result

from fem_seal.cli import app as cli
from fem_seal.errors import DrawingError
from fem_seal.output import pdf
from fem_seal.output.pictures.leak import leak_picture
from fem_seal.output.pictures.style import style
from fem_seal.output.report.page import _escape_for_css, report


@pytest.mark.slow
def test_a_page_becomes_pages(tmp_path):
    if pdf.find_browser() is None:
        pytest.skip("no Chromium, Chrome or Edge on this machine")
    page = tmp_path / "report.html"
    page.write_text("<!DOCTYPE html><h1>one</h1><h1 style='break-before: page'>two</h1>")
    written = pdf.print_pdf(page, tmp_path / "out.pdf").read_bytes()
    assert written.startswith(b"%PDF") and written.count(b"/Type /Page\n") == 2


@pytest.mark.slow
def test_one_page_is_one_page_that_can_be_read(tmp_path):
    # letters of the tables are the smallest [pt]
    assert min(zoom for _, zoom in pdf._FITS) * 7.5 > 7.0
    if pdf.find_browser() is None:
        pytest.skip("no Chromium, Chrome or Edge on this machine")
    for full in (False, True):
        page = tmp_path / "report.html"
        page.write_text(report(rough_result(), full=full), encoding="utf-8")
        written = pdf.print_pdf(page, tmp_path / "page.pdf", one_page=True).read_bytes()
        assert len(pdf._PAGES.findall(written)) == 1


def test_without_a_browser_the_reader_is_told_what_to_do(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(pdf, "find_browser", lambda: None)
    (tmp_path / "report.html").write_text("page")
    assert cli.main(["pdf", str(tmp_path)]) == cli.OTHER_FAILURE
    assert "open it in any browser and print it there" in capsys.readouterr().err


def test_a_folder_without_report_is_refused(tmp_path, capsys):
    assert cli.main(["pdf", str(tmp_path)]) == cli.WRONG_INPUT
    assert "holds no report.html" in capsys.readouterr().err


@pytest.mark.parametrize("fault", ["silent", "slow", "missing"])
def test_a_browser_that_prints_nothing_leaves_the_old_file(tmp_path, monkeypatch, fault):
    def run(command, **_):
        if fault == "slow":
            raise subprocess.TimeoutExpired(command, 1.0)
        if fault == "missing":
            raise FileNotFoundError(2, "No such file")
        return SimpleNamespace(stderr=b"cannot open display\n")

    monkeypatch.setattr(subprocess, "run", run)
    old = tmp_path / "report.pdf"
    old.write_text("old")
    with pytest.raises(DrawingError, match="printed nothing"):
        pdf.print_pdf(tmp_path / "report.html", old, "browser")
    assert old.read_text() == "old"


def test_a_named_browser_comes_first(monkeypatch):
    monkeypatch.setenv("FEM_SEAL_BROWSER", "/my/browser")
    assert pdf.find_browser() == "/my/browser"


def test_pictures_turn_dark_with_the_screen_and_not_on_paper():
    with style():
        picture = leak_picture(rough_result())
    assert picture is not None and picture.dark
    drawn = picture.svg.decode()
    assert "@media screen and (prefers-color-scheme: dark)" in drawn
    # white becomes nearly black
    assert '[style*="fill: #ffffff"]{fill:#171717 !important}' in drawn


def test_no_title_leaves_the_style_of_the_page():
    told = _escape_for_css('"}</style><script>& \\')
    assert not set(told) & set("\"}<>&/{'") and "\\22 " in told

"""A server on a folder of its own, and a page on it in Chromium."""

from __future__ import annotations

import fcntl
import os
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from PIL import Image
from playwright.sync_api import Browser, Page

import symofros.studio.editor
from tests.studio.editor.browser import steps
from tests.studio.editor.browser.measures import noted
from tests.studio.pictures import without_overlays

TOKEN = "token-of-the-tests"
# The oldest that builds the page.
NODE = (20, 19)
LOOKS = 4  # By axe, a second apart.
# Where pictures for docs/editor.md go, when they are wanted.
PICTURES = os.environ.get("SYMOFROS_PICTURES")
# By how much the server's answers and events come later to the page, each at most [ms]: a busy machine does that.
LATE = int(os.environ.get("SYMOFROS_LATE", "0"))
# How many times slower the page's own code runs: a busy machine does that, too.
SLOW = float(os.environ.get("SYMOFROS_SLOW_PAGE", "1"))
_DELAY = """{
const later = setTimeout.bind(window), get = window.fetch.bind(window), add = EventTarget.prototype.addEventListener;
const pause = () => new Promise((done) => later(done, Math.random() * %d / 2));
window.fetch = async (...asked) => {
  await pause();
  return get(...asked).finally(pause);
};
let before = Promise.resolve();
EventSource.prototype.addEventListener = function (kind, hear) {
  const heard = (event) => (before = before.then(pause).then(() => hear(event)));
  add.call(this, kind, kind === "error" ? hear : heard);
};
}"""


class Server:
    """`symofros edit FILE` in a process of its own."""

    def __init__(self, file: Path, port: int = 0, token: str = TOKEN) -> None:
        self.file = file
        command = [sys.executable, "-m", "symofros", "edit", str(file), "--no-browser", "--port", str(port)]
        self.process = subprocess.Popen(
            [*command, "--token", token], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
        )
        assert self.process.stdout is not None
        self.url = self.process.stdout.readline().strip()
        assert self.url.startswith("http://127.0.0.1:"), self.url + self.process.stdout.read()

    @property
    def port(self) -> int:
        return int(self.url.split(":")[2].split("/")[0])

    def kill(self) -> None:
        """End it as a crash would."""
        self.process.send_signal(signal.SIGKILL)
        self.process.wait()

    def stop(self) -> None:
        self.process.terminate()
        try:
            self.process.wait(10)
        except subprocess.TimeoutExpired:
            self.kill()


# What fixtures give: a server of a file, the faults that a page has, a picture under a name.
Serve = Callable[..., Server]
Faults = Callable[[], list[str]]
Picture = Callable[[str], None]


@pytest.fixture
def serve(tmp_path: Path) -> Iterator[Serve]:
    """Starts servers: `serve("double.yaml")` in the test's folder, a copy of `source` or with `content`."""
    servers: list[Server] = []

    def start(name: str, source: Path | None = None, content: str = "", **more: object) -> Server:
        if source is not None:
            shutil.copy(source, tmp_path / name)
        elif content:
            (tmp_path / name).write_text(content)
        servers.append(Server(tmp_path / name, **more))  # type: ignore[arg-type]
        return servers[-1]

    yield start
    for server in servers:
        server.stop()


@pytest.fixture
def page(chromium: Browser) -> Iterator[Page]:
    """A page whose own errors fail the test."""
    context = chromium.new_context(
        viewport={"width": 1280, "height": 760}, color_scheme="light", reduced_motion="reduce"
    )
    context.grant_permissions(["clipboard-read", "clipboard-write"])
    page = _hindered(context.new_page())
    page.set_default_timeout(60_000)  # Software rendering on a busy machine.
    errors: list[str] = []
    page.on("pageerror", lambda error: errors.append(str(error)))
    page.on("console", lambda message: errors.append(message.text) if _is_ours(message.type, message.text) else None)
    yield page
    context.close()
    assert not errors


@pytest.fixture
def opened(serve: Serve, page: Page) -> Serve:
    """Serves a file, as `serve` does, and opens it in the page."""

    def start(*file: Any, **more: Any) -> Server:
        server = serve(*file, **more)
        steps.open_editor(page, server.url)
        return server

    return start


@pytest.fixture
def arm(opened: Serve) -> Server:
    """A double pendulum, open in the page."""
    return opened("arm.yaml", source=steps.PENDULUM)


@pytest.fixture
def other(arm: Server, chromium: Browser) -> Iterator[Page]:
    """Another page on the server of the double pendulum."""
    page = _hindered(chromium.new_page())
    steps.open_editor(page, arm.url)
    yield page
    page.close()


def _hindered(page: Page) -> Page:
    if LATE:
        page.add_init_script(_DELAY % LATE)
    if SLOW > 1:
        page.context.new_cdp_session(page).send("Emulation.setCPUThrottlingRate", {"rate": SLOW})
    return page


def _is_ours(kind: str, text: str) -> bool:
    """Whether a message of the console is a fault of the page; refusals and a dead server are part of some tests.

    Viser's client reports a change that reaches it before its control does, or after it is gone; seen once, as a panel
    was replaced. What a test needs of a control it waits for.
    """
    crossed = text.startswith("Tried to update non-existent component")
    return kind == "error" and "Failed to load resource" not in text and "ERR_" not in text and not crossed


def _node_version() -> tuple[int, ...]:
    """Version of Node, if it and its package manager are there."""
    if shutil.which("node") is None or shutil.which("npm") is None:
        return ()
    text = subprocess.run(["node", "--version"], capture_output=True, text=True, check=True).stdout
    return tuple(int(part) for part in text.strip().removeprefix("v").split(".")[:2])


@pytest.fixture(scope="session")
def node_modules() -> Path:
    """The page's packages, installed as its lock file says if they are not there."""
    version = _node_version()
    if version < NODE:
        pytest.skip(f"needs Node {'.'.join(map(str, NODE))} or newer, found {version or 'none'}")
    folder = Path(symofros.studio.editor.__file__).parent / "page"
    with (folder / "package-lock.json").open() as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)  # Workers of one run share the folder.
        if not (folder / "node_modules" / ".package-lock.json").is_file():  # npm writes it last.
            subprocess.run(["npm", "ci", "--no-audit", "--no-fund"], cwd=folder, check=True)
    return folder / "node_modules"


@pytest.fixture
def faults(page: Page, node_modules: Path) -> Faults:
    """Runs axe on what the page shows now, and again where a page that still settles has faults: those that stay."""
    source = (node_modules / "axe-core" / "axe.min.js").read_text()

    def look() -> list[str]:
        for _ in range(LOOKS - 1):
            if not found():
                noted("axe", findings=[])
                return []
            page.wait_for_timeout(1000)
        faults = found()
        noted("axe", findings=faults)
        return faults

    def found() -> list[str]:
        page.evaluate(source)
        # The frame of the 3-D pane holds viser's page.
        run = "axe.run(document, {iframes: false}).then(result => result.violations)"
        faults: list[dict[str, Any]] = page.evaluate(run)
        return [f"{fault['id']}: {fault['help']}: {node['target']}" for fault in faults for node in fault["nodes"]]

    return look


@pytest.fixture
def picture(page: Page) -> Picture:
    """Keeps what the page shows as a picture of the documentation, when SYMOFROS_PICTURES names a folder."""

    def shoot(name: str) -> None:
        if PICTURES:
            if page.locator("iframe.view, canvas").count() > 0:  # The 3-D pane's picture, or a replay's.
                without_overlays(page)
            page.wait_for_timeout(300)  # Movements of the diagram come to rest.
            file = Path(PICTURES) / f"editor-{name}.png"
            page.screenshot(path=file)
            # Few colours are enough for it, and make it small; k-means has those of large areas as they are.
            few = Image.open(file).convert("RGB").quantize(255, Image.Quantize.MAXCOVERAGE, 1, None, Image.Dither.NONE)
            few.save(file, optimize=True)

    return shoot

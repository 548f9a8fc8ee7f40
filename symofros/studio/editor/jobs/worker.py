"""What a worker process does: reads a request, says how far it is, answers, waits for the next one.

Lines of JSON: in comes the request, and after it orders, a word each; out go {"progress": …}, {"samples": …}, and at
last {"result": …} or {"error": …}. What was imported and compiled for one request is there for the next. When the
server is gone, the pipe of requests ends, and so does the worker with all that it started.
"""

from __future__ import annotations

import json
import os
import signal
import threading
import traceback
from collections.abc import Callable
from dataclasses import replace
from queue import SimpleQueue
from typing import Any

from symofros.errors import Problem, SymofrosError
from symofros.studio.editor.editing.data_edits import four_parts
from symofros.studio.editor.jobs.request import Json, Tell


def error_of(error: Exception) -> Json:
    """An exception as the four parts that the page shows: its first problem, and how many more there are."""
    if not isinstance(error, SymofrosError):
        return {**four_parts(Problem(str(error) or type(error).__name__))}
    first, rest = error.problem, len(error.problems) - 1
    more = f" (and {rest} more)" if rest else ""
    return four_parts(replace(first, what=first.what + more))


def main() -> None:
    """Serve one request after the other."""
    # Whatever writes to the standard output, a compiler or a library, must not garble the answer.
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)

    def say(message: Json) -> None:
        answers.write(json.dumps(message) + "\n")
        answers.flush()

    requests: SimpleQueue[tuple[Json, Tell]] = SimpleQueue()
    threading.Thread(target=_follow_the_server, args=(say, requests), daemon=True).start()
    task("simulate")  # Its imports take longer than most requests.
    while True:
        _serve(*requests.get())


def _serve(request: Json, tell: Tell) -> None:
    """Answer one request."""
    try:
        tell.say({"result": task(request["kind"])(request, tell)})
    except (SymofrosError, ValueError, OSError) as error:
        tell.say({"error": error_of(error)})
    except Exception as error:
        traceback.print_exc()
        tell.say({"error": {**error_of(error), "rule": "this should not happen", "remedy": "please report it"}})


def task(kind: str) -> Callable[[Json, Tell], Any]:
    """The function that runs a kind of job; only the packages that it needs are imported."""
    if kind == "run":
        from symofros.studio.editor.jobs.diagram_run import run_diagram  # With the library of blocks.

        return run_diagram
    if kind == "analyse":
        from symofros.studio.editor.jobs.sweeps import analyse  # With the drawing of mechanisms, and advice.

        return analyse
    from symofros.studio.editor.jobs import operations  # With exports and advice.

    return operations.TASKS[kind]


def _follow_the_server(say: Callable[[Json], None], requests: SimpleQueue[tuple[Json, Tell]]) -> None:
    """Pass the server's lines on, requests and the orders to each, and end with the server."""
    orders: SimpleQueue[str] = SimpleQueue()
    line = b""
    # By the descriptor: a buffered read would hold a lock that the end of the interpreter waits for.
    while data := os.read(0, 65536):
        *lines, line = (line + data).split(b"\n")
        for text in (each.decode(errors="replace") for each in lines):
            if text.startswith("{"):
                tell = Tell(say)
                orders = tell.orders  # What the last request did not follow is not for this one.
                requests.put((json.loads(text), tell))
            else:
                orders.put(text)
    os.killpg(0, signal.SIGKILL)


if __name__ == "__main__":
    main()

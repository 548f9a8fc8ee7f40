"""A page that simulates by itself: the job that makes it, its address, what it may do."""

from __future__ import annotations

import pytest
from starlette.testclient import TestClient

from tests.late import require
from tests.studio.editor.conftest import TOKEN, finished

require("ziglang", "zig")


@pytest.mark.slow  # In every run: that addresses of pages have their own token (test_document_viewer.py).
def test_the_page_is_kept_apart_and_its_address_has_a_token_of_its_own(client: TestClient) -> None:
    job = finished(client, "page", 300.0, q0={"q1": 1.2}, v0={"q1": 0.5}, method="rk4", dt=1e-3)
    assert job["state"] == "done" and set(job["result"]) == {"address", "notes"}
    address = job["result"]["address"]
    assert address.startswith("/view/") and TOKEN not in address
    page = client.get(address, headers={"Authorization": ""})
    assert page.status_code == 200 and "WebAssembly.instantiate" in page.text
    policy = page.headers["content-security-policy"]
    assert policy.startswith("sandbox allow-scripts; default-src 'none'")
    assert page.headers["cache-control"] == "no-store"
    known = address.split("/")[2]
    assert client.get(address.replace(known, "x" * len(known))).status_code == 401
    assert client.get(f"/view/{known}/page/99").status_code == 422
    assert client.get(f"{address}/more").status_code == 401
    wrong = finished(client, "page", method="cvode")
    assert wrong["state"] == "failed" and "cvode" in wrong["error"]["object"]

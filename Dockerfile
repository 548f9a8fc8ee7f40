# The README's two commands, each on a fresh machine of its own:
#   docker build --target check -t symofros-check . && docker run --rm symofros-check
#   docker build --target test -t symofros-test . && docker run --rm symofros-test
FROM python:3.12-slim AS machine
# The distribution's versions are right: any C compiler serves.
# hadolint ignore=DL3008
RUN apt-get update && apt-get install -y --no-install-recommends gcc libc6-dev && rm -rf /var/lib/apt/lists/*
WORKDIR /symofros
COPY . .

FROM machine AS check
RUN python3 -m venv .venv && .venv/bin/pip install -q -e '.[validation]'
CMD [".venv/bin/python", "-m", "validation"]

FROM machine AS test
RUN python3 -m venv .venv && .venv/bin/pip install -q -e '.[test]'
CMD [".venv/bin/python", "-m", "pytest"]

"""WebAssembly: a model in a web page or in Node, without a server."""

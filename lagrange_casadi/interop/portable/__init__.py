"""A scene as C that stands alone, and as WebAssembly for pages."""

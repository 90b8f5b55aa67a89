"""Cross-sections, materials and notches of links."""

"""Pictures: figures, animations and pages."""

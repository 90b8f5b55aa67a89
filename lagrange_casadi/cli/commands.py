"""The commands in their groups: MODULE.FUNCTION of each."""

GROUPS = {
    "Run": ("run.run", "info.info", "check.check", "cases.cases", "cases.new"),
    "Many designs": ("sweep.sweep", "table.best", "table.table"),
    "Design": (
        "optimise.optimise",
        "size.size",
        "drive.drive",
        "free.free",
        "tolerances.tolerances",
        "trade.trade",
    ),
    "Measurements": ("identify.identify",),
    "Other programs": ("export.export", "loads.loads"),
    "Look": ("draw.draw", "watch.watch", "plot.plot", "page.report", "animate.animate"),
    "Cache": ("cache.cache",),
}

PLACES = {place.partition(".")[2]: place for group in GROUPS.values() for place in group}
"""The commands by their names."""

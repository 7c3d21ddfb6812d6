"""Files that the viewer writes, each atomically: pictures and videos."""

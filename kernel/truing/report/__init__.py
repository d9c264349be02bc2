"""The calculation sheet: neutral content first, then HTML, Markdown and PDF from the same content."""

"""What the paper prints, beside what this calculation gives, and where the paper cannot be right."""

from truing import Finding, Published

PUBLISHED: list[Published] = []
FINDINGS: list[Finding] = []

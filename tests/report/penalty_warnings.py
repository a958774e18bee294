"""Warnings of report pages but the one that every door seal with the paper's penalties has."""

import re


def further_warnings(text: str) -> list[str]:
    """Warnings of a page that are not about contact penalties."""
    found = re.findall(r'<p class="warning">(.*?)</p>', text)
    return [line for line in found if "the contact penalties permit penetration" not in line]

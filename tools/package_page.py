"""The README as a package page shows it: links lead to the repository. Called by the build."""

import re
import tomllib
from pathlib import Path
from typing import Any

from hatchling.metadata.plugin.interface import MetadataHookInterface


def package_page(readme: str, repository: str) -> str:
    """Lead the links of a README that are relative, and its pictures, to a repository."""
    pictures = re.sub(r"(!\[[^\]]*\]\()(?!\w+:)([^)]+)\)", rf"\1{repository}/raw/main/\2)", readme)
    return re.sub(r"(?<!!)(\[[^\]]*\]\()(?!\w+:|#)([^)]+)\)", _to_file(repository), pictures)


def _to_file(repository: str) -> Any:
    return lambda link: f"{link[1]}{repository}/blob/main/{link[2]})"


class CustomMetadataHook(MetadataHookInterface):
    """What hatchling asks for the fields that are dynamic."""

    def update(self, metadata: dict[str, Any]) -> None:
        """Set the readme."""
        root = Path(self.root)
        project = tomllib.loads((root / "pyproject.toml").read_text(encoding="utf-8"))["project"]
        text = (root / "README.md").read_text(encoding="utf-8")
        page = package_page(text, project["urls"]["Repository"])
        metadata["readme"] = {"content-type": "text/markdown", "text": page}

"""Names in a seal file: every term of the seal has one of its own."""

from seal_mdao.errors import SealFileError
from seal_mdao.seals.file.tables import SealFile


def check_names(file: SealFile) -> None:
    """Refuse cavities, fluids, terms and contact of the section with itself under a taken name.

    Raises
    ------
    SealFileError
        With the table and what has the name already.
    """
    seen = {"structure": "the body itself"} | {p.name: "a profile" for p in file.profiles}
    for kind, rows in (("cavity", file.cavities), ("fluid", file.fluids), ("term", file.terms)):
        for number, row in enumerate(rows, 1):
            where = f"[[{kind}]] {number}"
            if row.name in seen:
                raise SealFileError(
                    f"{where}: name = {row.name!r}, but {seen[row.name]} has it; give every {kind} a "
                    "name of its own"
                )
            seen[row.name] = where
    if file.self_contact is not None and "self_contact" in seen:
        raise SealFileError(
            f"[self_contact]: {seen['self_contact']} has the name 'self_contact'; give it another one"
        )

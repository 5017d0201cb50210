"""The glasses that a lens file names: of catalogues beside the file, and of the makers' catalogue."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cached_property
from pathlib import Path

from render.errors import InputError
from render.model.lens import Glass
from render.optics.dispersion.formulas import index_and_abbe
from render.optics.dispersion.names import agreeing_glass, find_glass, find_in_catalogue, is_its_name, near_glasses
from render.optics.lens_files.agf import MAX_AGF_BYTES, AgfGlass, read_agf
from render.optics.lens_files.lens_text import UNKNOWN_GLASS, LensText, decode

_MOST_CATALOGUES = 16
_INDICES, _ABBES = (1.3, 2.8), (10.0, 110.0)  # of media that lenses are made of
# Numbers that OpticStudio writes behind the name of a catalogue's glass, and that are not its own.
_NO_INDEX = (1.5, 40.0)


class FileGlasses:
    """Finds the glasses of a lens file.

    Attributes:
        makers: catalogues that the file names, the first wins where several have a glass of one name.
        notes: what was found under another name, or taken as the file describes it, one sentence each.
    """

    def __init__(self, text: LensText, folder: Path | None = None, allow_unknown: bool = False) -> None:
        """Make the finder.

        Args:
            text: the lens file, for messages.
            folder: of the file; its `.agf` catalogues win over the makers'. None for a file in memory.
            allow_unknown: take an unknown glass by the index and the Abbe number beside its name.
        """
        self.makers: tuple[str, ...] = ()
        self.notes: list[str] = []
        self._text, self._folder, self._allow_unknown = text, folder, allow_unknown

    def find(self, name: str, line: int, surface: str, described: Callable[[], Glass | None] = lambda: None) -> Glass:
        """The glass of a name or of a code.

        Args:
            name: as it stands in the file.
            line: counted from 1, for messages.
            surface: as the file counts it, for messages.
            described: returns the glass by the numbers beside its name, or None where there are none; asked for unknown glass
                alone.

        Raises:
            InputError: no catalogue has such a glass; the message has the nearest names.
        """
        own = self._own.get(name.upper())
        if own is not None:
            index, abbe = index_and_abbe(own.dispersion)
            return Glass(index, abbe, name=name, dispersion=own.dispersion)
        glass = find_glass(name, self.makers)
        if glass is None:
            return self._unknown(name, line, surface, described)
        found = find_in_catalogue(name, self.makers)
        if found is not None and not is_its_name(name, found):
            self._note(f"Glass {name} is {found.name} of {found.maker} in today's catalogue.")
        return glass

    def agreeing(self, described: Glass) -> Glass:
        """The catalogue's glass where its name, index and Abbe number are the described ones, else the described one."""
        return agreeing_glass(described.name, described.index, described.abbe) or described

    def _unknown(self, name: str, line: int, surface: str, described: Callable[[], Glass | None]) -> Glass:
        glass = described() if self._allow_unknown else None
        if glass is not None and _makes_sense(glass):
            self._note(f"Glass {name} is in no catalogue: n_d {glass.index:g} and V_d {glass.abbe:g} are the file's.")
            return glass
        near = near_glasses(name)
        hint = f", did you mean {' or '.join(near)}?" if near else ""
        numbers = ", and has no usable index and Abbe number in the file" if self._allow_unknown else ""
        error = self._text.error(
            f"glass {name[:40] or 'without name'} is in no catalogue{numbers}{hint}", line, surface
        )
        raise InputError(error.detail, code=UNKNOWN_GLASS, path=error.path)

    def _note(self, note: str) -> None:
        if note not in self.notes:
            self.notes.append(note)

    @cached_property
    def _own(self) -> Mapping[str, AgfGlass]:
        """Glasses of the catalogues beside the file, by names in capitals."""
        glasses: dict[str, AgfGlass] = {}
        for path in _catalogues_in(self._folder) if self._folder is not None else ():
            try:
                with path.open("rb") as file:
                    data = file.read(MAX_AGF_BYTES + 1)
            except OSError as error:
                raise InputError(
                    f"glass catalogue {path} cannot be read: {error.strerror}", code="bad_lens_file", path=str(path)
                ) from error
            found = read_agf(decode(data, path.name, MAX_AGF_BYTES))
            glasses = {name.upper(): glass for name, glass in found.items()} | glasses
        return glasses


def _catalogues_in(folder: Path) -> list[Path]:
    """The `.agf` files of a folder, by name; links are not followed."""
    try:
        files = [path for path in folder.iterdir() if path.suffix.lower() == ".agf"]
    except OSError:
        return []
    return sorted(path for path in files if path.is_file() and not path.is_symlink())[:_MOST_CATALOGUES]


def _makes_sense(glass: Glass) -> bool:
    numbers = glass.index, glass.abbe
    return numbers != _NO_INDEX and _INDICES[0] <= glass.index <= _INDICES[1] and _ABBES[0] <= glass.abbe <= _ABBES[1]

"""The scene files that both renderers read, and how they are prepared."""

import re
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Scene:
    """One scene file, its parameters and the path depth at which it is compared."""

    name: str
    file: str
    width: int
    height: int
    max_depth: int
    parameters: tuple = ()

    def size(self, scale):
        """Image size at `scale` times the film size of the file."""
        return max(1, round(self.width * scale)), max(1, round(self.height * scale))


# Sizes and depths are those of the files, but for veach-mis, whose depth 3 would leave out all interreflection.
SCENES = [
    Scene("cornell-box", "cornell-box/scene.xml", 1024, 1024, 30, (("integrator", "path"),)),
    Scene("veach-mis", "veach-mis/scene.xml", 1280, 720, 10, (("integrator", "path"),)),
    Scene("modern-hall", "modern-hall/scene_mi3.xml", 1280, 720, 65),
    Scene("living-room", "living-room/scene_mi3.xml", 1280, 720, 65),
    Scene("water-caustic", "water-caustic/scene_mi3.xml", 1024, 1024, 9),
]


def select(names):
    """The scenes called `names`, in the order of the table; all of them when `names` is empty."""
    unknown = set(names) - {scene.name for scene in SCENES}
    if unknown:
        raise SystemExit(f"unknown scene {sorted(unknown)[0]}; known: {', '.join(s.name for s in SCENES)}")
    return [scene for scene in SCENES if not names or scene.name in names]


def with_box_filter(scene, assets, folder):
    """A copy of the scene file whose reconstruction filter is a box, next to links to everything it refers to.

    Nothing else changes. With a box the pixels are independent and no renderer's filter enters the comparison.
    """
    original = Path(assets).resolve() / scene.file
    target = Path(folder) / scene.name
    target.mkdir(parents=True, exist_ok=True)
    for entry in original.parent.iterdir():
        if entry != original and not (target / entry.name).exists():
            (target / entry.name).symlink_to(entry)
    text, count = re.subn(r'(<rfilter\b[^>]*\btype=")\w+(")', r"\g<1>box\2", original.read_text())
    if count != 1:
        raise SystemExit(f"{original}: expected one rfilter, found {count}")
    (target / original.name).write_text(text)
    return target / original.name

"""The scene of a run: parameters.prm, in which slipstick prints every parameter."""

from . import formula


class Scene:
    """Values by path, "Contact circle/Law", in the order of the file."""

    def __init__(self, text):
        self.values = {}
        path = []
        for line in text.splitlines():
            words = line.split("#")[0].split(None, 1)
            if not words:
                continue
            if words[0] == "subsection":
                path.append(" ".join(words[1].split()))
            elif words[0] == "end":
                path.pop()
            elif words[0] == "set":
                name, _, value = words[1].partition("=")
                self.values["/".join(path + [" ".join(name.split())])] = value.strip()

    @classmethod
    def of(cls, folder):
        """Of the folder of a run; empty where there is no parameters.prm."""
        file = folder / "parameters.prm"
        return cls(file.read_text(encoding="utf-8", errors="replace") if file.is_file() else "")

    def get(self, path, default=""):
        return self.values.get(path, default)

    def names(self, names):
        """Of a list such as Obstacles."""
        return [" ".join(name.split()) for name in self.get(names).split(",") if name.strip()]

    def numbers(self, path, default=()):
        try:
            return [float(part) for part in self.get(path).split(",")]
        except ValueError:
            return list(default)

    def field(self, path, x, y, t):
        """Value of a FIELD; None for what is free, empty, or not understood."""
        text = self.get(path)
        return None if text in ("", "free", "geometry") else formula.value(text, x, y, t)

    def load_factors(self):
        """Numbers, and ranges FIRST:STEP:LAST."""
        factors = []
        try:
            for part in self.get("Load steps/Factors", "1").split(","):
                numbers = [float(number) for number in part.split(":")]
                n = int((numbers[2] - numbers[0]) / numbers[1] * (1 + 1e-12) + 1e-9) if len(numbers) == 3 else 0
                factors += [numbers[0] + k * numbers[1] for k in range(n + 1)] if n else numbers[:1]
        except ValueError:
            pass
        return factors or [1.]

    def has_given_gaps(self):
        """Whether gaps of contact pairs are other than those between the bodies as they are drawn."""
        return any(self.get(f"Contact {name}/Gap", "geometry") != "geometry" or
                   formula.value(self.get(f"Contact {name}/Offset", "0")) != 0 for name in self.names("Contacts"))

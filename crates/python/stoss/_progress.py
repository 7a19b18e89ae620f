"""Progress of a run: a bar in a terminal and in a notebook, nothing elsewhere."""

import html
import sys
import time


def _notebook():
    """Makes what shows text in a notebook; None elsewhere."""
    try:
        shell = sys.modules["IPython"].get_ipython()
    except (KeyError, AttributeError):
        return None
    if shell is None or not hasattr(shell, "kernel"):
        return None
    from IPython.display import HTML, display

    handle = display(HTML(""), display_id=True)
    return (lambda text, part: handle.update(HTML(_bar(text, part)))) if handle is not None else None


def _bar(text, part):
    return f'<progress max="1" value="{part:.4f}" style="width:16em"></progress> <code>{html.escape(text)}</code>'


class Progress:
    """Shows how far a run is, at most ten times a second."""

    def __init__(self, title, end, wanted):
        self.title, self.end = title, end
        self.began = self.last = time.monotonic()
        self.notebook = _notebook() if wanted is not False else None
        self.stream = sys.stderr if wanted or (wanted is None and self.notebook is None and sys.stderr.isatty()) else None
        self.text = ""

    def show(self, last, force=False):
        """After a step: number, time and so on."""
        if self.notebook is None and self.stream is None:
            return
        now = time.monotonic()
        if not force and now - self.last < 0.1:
            return
        self.last = now
        step, at, _, iterations, _, drift, depth = last
        part = min(max(at / self.end, 0.0), 1.0)
        spent = now - self.began
        left = f" < {spent * (1 / part - 1):.0f} s" if 0 < part < 1 else ""
        drift = f"  drift {drift:.1e}" if drift is not None else ""
        depth = f"  depth {depth:.3f} edges" if depth > 0 else ""
        text = f"step {step}  t = {at:.6g} of {self.end:.6g}  Newton {iterations}{drift}{depth}  [{spent:.0f} s{left}]"
        if self.notebook is not None:
            self.notebook(text, part)
        else:
            done = round(24 * part)
            line = f"{'#' * done}{'-' * (24 - done)} {100 * part:3.0f} % {text}"
            self.stream.write("\r" + line.ljust(len(self.text)))
            self.stream.flush()
            self.text = line

    def close(self, last):
        """The end of the run."""
        self.show(last, force=True)
        if self.stream is not None and self.text:
            self.stream.write("\n")

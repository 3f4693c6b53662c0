"""The page on which people rate clips; it needs no server, and saves the filled-in form as CSV."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from pathlib import Path
from string import Template

from data_collection.files import replacing


def write_page(clips: Sequence[tuple[str, str, Sequence[str]]], title: str, path: Path) -> None:
    """Write the page.

    Args:
        clips: name, path of the picture relative to the page, and allowed words of each clip.
        title: Heading of the page.
        path: The page.
    """
    figures = "\n".join(_figure(number, *clip) for number, clip in enumerate(clips, start=1))
    with replacing(path) as (temporary,):
        temporary.write_text(_PAGE.substitute(title=escape(title), clips=figures, count=len(clips)), encoding="utf-8")


def _figure(number: int, name: str, picture: str, words: Sequence[str]) -> str:
    choices = "".join(
        f'<label><input type="radio" name="{escape(name)}" value="{escape(word)}"> {escape(word)}</label>'
        for word in words
    )
    image = f'<img src="{escape(picture)}" alt="clip {number}" loading="lazy">'
    data = f'data-clip="{escape(name)}" data-allowed="{escape(" ".join(words))}"'
    return f"<fieldset {data}><legend>{number}</legend>{image}<p>{choices}</p></fieldset>"


_PAGE = Template("""<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>$title</title>
<style>
body { font: 16px/1.5 system-ui, sans-serif; margin: 2em auto; max-width: 60em; padding: 0 1em; color: #222; }
form { display: grid; grid-template-columns: repeat(auto-fill, minmax(20em, 1fr)); gap: 1em; }
fieldset { border: 1px solid #ccc; } img { width: 100%; } label { margin-right: 1em; white-space: nowrap; }
.bar { position: sticky; bottom: 0; background: #fff; border-top: 1px solid #ccc; padding: .7em 0; }
</style></head>
<body><h1>$title</h1>
<p>Choose for each of the $count clips the word that says best what the robot does. Each clip runs again and again; at
its end it stands still for two seconds. When you are done, enter your name and save the form. A clip that you cannot
tell may stay empty.</p>
<form>
$clips
</form>
<p class="bar"><label>Your name <input id="rater"></label> <button id="save">Save the form</button>
<span id="said"></span></p>
<script>
document.getElementById("save").addEventListener("click", () => {
  const rater = document.getElementById("rater").value.trim(), said = document.getElementById("said");
  if (!rater) { said.textContent = "Please enter your name."; return; }
  const quoted = text => '"' + text.replaceAll('"', '""') + '"';
  let rated = 0;
  const rows = [...document.querySelectorAll("fieldset")].map(clip => {
    const chosen = clip.querySelector("input:checked");
    if (chosen) rated += 1;
    return [clip.dataset.clip, rater, chosen ? chosen.value : "", clip.dataset.allowed].map(quoted).join(",");
  });
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob(["clip,rater,word,allowed\\n" + rows.join("\\n") + "\\n"]));
  link.download = "form_" + rater.replace(/[^A-Za-z0-9_-]/g, "_") + ".csv";
  link.click();
  said.textContent = rated + " of $count clips rated.";
});
</script>
</body></html>
""")

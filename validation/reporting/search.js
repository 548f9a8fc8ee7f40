"use strict";
// Rows of the table of this place that have all words of what is typed; without words, the first of them.
{
  const FIRST = 12;
  const place = document.currentScript.parentElement;
  const field = place.querySelector("input");
  const said = place.querySelector("[role=status]");
  const rows = [...place.querySelectorAll("tr")].slice(1);
  const show = () => {
    const words = field.value.toLowerCase().split(/\s+/).filter(Boolean);
    let found = 0;
    let shown = 0;
    for (const row of rows) {
      const text = row.textContent.toLowerCase();
      const has = words.every((word) => text.includes(word));
      found += has;
      row.hidden = !has || (!words.length && found > FIRST);
      shown += !row.hidden;
    }
    said.textContent = words.length ? `${found} of ${rows.length} rows` : `The first ${shown} of ${rows.length} rows`;
  };
  field.addEventListener("input", show);
  show();
}

// Faults of the page as it is laid out now, in words. Runs in the page; returns a list of texts.
(() => {
  const faults = [];
  const shown = (e) => e.getClientRects().length > 0;
  const name = (e) => {
    const id = e.closest("[id]");
    const words = (e.textContent || "").trim().slice(0, 40);
    return `${e.tagName.toLowerCase()} in #${id ? id.id : "?"} “${words}”`;
  };
  const scrolls = (e) => e.closest(".table, pre");

  // Nothing may be wider than the window, except what scrolls in a box of its own.
  const root = document.documentElement;
  if (root.scrollWidth > window.innerWidth) {
    faults.push(`the page is ${root.scrollWidth} pixels wide in a window of ${window.innerWidth}`);
    const wide = [...document.querySelectorAll("body *")].filter((e) => shown(e) && !scrolls(e) && e.getBoundingClientRect().right > window.innerWidth + 1);
    for (const e of wide.slice(0, 5)) faults.push(`too wide: ${name(e)}`);
  }

  // No words of a plot may be cut off, lie on others, or be too small to read.
  for (const svg of document.querySelectorAll("svg.plot")) {
    if (!shown(svg)) continue;
    const frame = svg.getBoundingClientRect();
    const scale = frame.width / svg.viewBox.baseVal.width;
    const words = [...svg.querySelectorAll("text")].filter((t) => t.textContent.trim());
    const boxes = words.map((t) => ({ t, r: t.getBoundingClientRect() }));
    for (const { t, r } of boxes) {
      const out = r.left < frame.left - 2 || r.right > frame.right + 2 || r.top < frame.top - 2 || r.bottom > frame.bottom + 2;
      if (out) faults.push(`cut off: ${name(t)}`);
      const size = parseFloat(getComputedStyle(t).fontSize) * scale;
      if (size < 9) faults.push(`${size.toFixed(1)} pixels are too small to read: ${name(t)}`);
    }
    boxes.forEach((a, i) => {
      for (const b of boxes.slice(i + 1)) {
        const width = Math.min(a.r.right, b.r.right) - Math.max(a.r.left, b.r.left);
        const height = Math.min(a.r.bottom, b.r.bottom) - Math.max(a.r.top, b.r.top);
        if (width > 1 && height > 4) faults.push(`words on words: ${name(a.t)} and ${name(b.t)}`);
      }
    });
  }

  // Words that leave their paragraph.
  for (const e of document.querySelectorAll("p, li, h1, h2, h3, dd, dt, figcaption")) {
    if (shown(e) && !scrolls(e) && e.scrollWidth > e.clientWidth + 1) faults.push(`words leave their box: ${name(e)}`);
  }

  for (const image of document.images) {
    if (!image.complete || image.naturalWidth === 0) faults.push(`a picture is broken: ${image.alt}`);
    if (!image.alt) faults.push("a picture doesn't say what it shows");
  }
  const headings = [...document.querySelectorAll("h1, h2, h3")].map((h) => Number(h.tagName[1]));
  if (headings.filter((h) => h === 1).length !== 1) faults.push("the page should have one main heading");
  headings.forEach((h, i) => { if (i > 0 && h > headings[i - 1] + 1) faults.push(`a heading of level ${h} below one of level ${headings[i - 1]}`); });
  const ids = [...document.querySelectorAll("[id]")].map((e) => e.id);
  ids.filter((id, i) => ids.indexOf(id) !== i).forEach((id) => faults.push(`the id ${id} is used twice`));
  for (const link of document.querySelectorAll('a[href^="#"]')) {
    if (!document.getElementById(link.getAttribute("href").slice(1))) faults.push(`a link leads nowhere: ${link.getAttribute("href")}`);
  }
  return faults;
})()

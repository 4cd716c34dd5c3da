"use strict";
// The report is complete without this script. It adds sorting, a filter by zone, tooltips, and the current position in the
// contents. It writes text only (textContent), never markup.
(() => {
  const all = (selector, root = document) => Array.from(root.querySelectorAll(selector));

  // Long tables of values are collapsed on screen, and expanded in print.
  const folds = all("details");
  folds.forEach(fold => { fold.open = false; });
  addEventListener("beforeprint", () => folds.forEach(fold => { fold.open = true; }));

  // Numbers in the report's format: true minus, narrow spaces, powers of ten. Other cells are sorted as text.
  const raised = "⁰¹²³⁴⁵⁶⁷⁸⁹";
  const numberOf = text => {
    let plain = text.replace(/[\u202f\u200b\s]/g, "").replace(/\u2212/g, "-");
    plain = plain.replace(/·10([⁻⁰¹²³⁴-⁹]+)$/, (_, power) =>
      "e" + Array.from(power, c => (c === "⁻" ? "-" : raised.indexOf(c))).join(""));
    return /^-?\d+(\.\d+)?(e-?\d+)?$/.test(plain) ? Number(plain) : null;
  };
  const compare = (a, b) => {
    const [x, y] = [numberOf(a), numberOf(b)];
    if (x !== null && y !== null) return x - y;
    if (x !== null || y !== null) return x !== null ? -1 : 1;
    return a < b ? -1 : a > b ? 1 : 0;
  };

  // Column of every header cell, including cells that span rows and columns.
  const columns = table => {
    const taken = [];
    const found = new Map();
    all("thead tr", table).forEach((row, y) => {
      let x = 0;
      for (const cell of row.cells) {
        while (taken[y] && taken[y][x]) x += 1;
        found.set(cell, x);
        for (let dy = 0; dy < cell.rowSpan; dy += 1)
          for (let dx = 0; dx < cell.colSpan; dx += 1) (taken[y + dy] ||= [])[x + dx] = true;
      }
    });
    return found;
  };

  const sort = (table, head, column) => {
    const down = head.getAttribute("aria-sort") === "ascending";
    all("thead th", table).forEach(cell => cell.removeAttribute("aria-sort"));
    head.setAttribute("aria-sort", down ? "descending" : "ascending");
    const body = table.tBodies[0];
    const text = row => row.cells[column].textContent.trim();
    const empty = row => text(row) === "" || text(row) === "–";
    const rows = Array.from(body.rows);
    rows.sort((a, b) => {
      // Cells without a value stay at the end in either order.
      if (empty(a) || empty(b)) return Number(empty(a)) - Number(empty(b));
      return (down ? -1 : 1) * compare(text(a), text(b));
    });
    body.append(...rows);
  };

  for (const table of all("table.sortable")) {
    if (table.tBodies[0].rows.length < 2) continue;
    for (const [head, column] of columns(table)) {
      if (head.colSpan > 1) continue;
      const button = document.createElement("button");
      button.type = "button";
      button.append(...head.childNodes);
      button.title = "Sort by this column";
      button.addEventListener("click", () => sort(table, head, column));
      head.append(button);
    }
  }

  // Filter by zone.
  const zoned = all("[data-zone]");
  const zones = [...new Set(zoned.map(it => it.dataset.zone))];
  const tools = document.getElementById("tools");
  if (zones.length > 1) {
    const label = document.createElement("label");
    label.htmlFor = "zone";
    label.textContent = "Show zone";
    const select = document.createElement("select");
    select.id = "zone";
    select.append(new Option("all", ""));
    zones.forEach(zone => select.append(new Option(zone, "=" + zone)));
    const remark = document.createElement("p");
    remark.hidden = true;
    remark.textContent = "Rows and marks of other zones are hidden. Statistics and verdict are always those of the whole campaign.";
    select.addEventListener("change", () => {
      remark.hidden = select.value === "";
      for (const it of zoned) {
        const away = select.value !== "" && "=" + it.dataset.zone !== select.value;
        if (it instanceof SVGElement) it.classList.toggle("faded", away);
        else it.hidden = away;
      }
    });
    addEventListener("beforeprint", () => { select.value = ""; select.dispatchEvent(new Event("change")); });
    tools.append(label, select, remark);
  }

  // Tooltips under the pointer, or by arrow keys in a focused figure.
  const tip = document.createElement("div");
  tip.id = "tip";
  tip.hidden = true;
  tip.setAttribute("role", "status");
  document.body.append(tip);
  const says = mark => {
    const title = mark.querySelector("title");
    if (title) {
      mark.dataset.says = title.textContent;
      title.remove();
    }
    return mark.dataset.says || "";
  };
  let lit = [];
  const hide = () => {
    tip.hidden = true;
    lit.forEach(it => it.classList.remove("same"));
    lit = [];
  };
  const show = (mark, x, y) => {
    hide();
    tip.textContent = says(mark);
    tip.hidden = tip.textContent === "";
    const section = mark.dataset.section;
    lit = section === undefined ? [mark] : all(".mark", mark.ownerSVGElement).filter(it => it.dataset.section === section);
    lit.forEach(it => it.classList.add("same"));
    tip.style.left = Math.max(4, Math.min(x + 12, innerWidth - tip.offsetWidth - 8)) + "px";
    tip.style.top = Math.max(4, y - tip.offsetHeight - 10) + "px";
  };
  for (const drawing of all(".drawing")) {
    const marks = all(".mark, .range, .row", drawing);
    if (marks.length === 0) continue;
    drawing.addEventListener("pointermove", event => {
      const mark = event.target.closest(".mark, .range, .row");
      if (mark) show(mark, event.clientX, event.clientY); else hide();
    });
    drawing.addEventListener("pointerleave", hide);
    drawing.tabIndex = 0;
    let at = -1;
    drawing.addEventListener("keydown", event => {
      const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
      if (event.key === "Escape") hide();
      if (step === undefined) return;
      event.preventDefault();
      at = (at + step + marks.length) % marks.length;
      const box = marks[at].getBoundingClientRect();
      show(marks[at], box.right, box.top);
    });
    drawing.addEventListener("blur", hide);
  }

  // Current position in the contents.
  const links = new Map(all("nav a").map(link => [link.getAttribute("href").slice(1), link]));
  const places = Array.from(links.keys(), id => document.getElementById(id)).filter(Boolean);
  const follow = () => {
    const passed = places.filter(place => place.getBoundingClientRect().top < 120);
    const here = passed.length > 0 ? passed[passed.length - 1] : places[0];
    links.forEach((link, id) => {
      if (here && id === here.id) link.setAttribute("aria-current", "location"); else link.removeAttribute("aria-current");
    });
  };
  let waiting = false;
  addEventListener("scroll", () => {
    if (waiting) return;
    waiting = true;
    requestAnimationFrame(() => { waiting = false; follow(); });
  }, { passive: true });
  follow();
})();

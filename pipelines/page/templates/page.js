/* What the pages do: tables sort and filter, heads and menu stay, figures enlarge. Without it all is there to read. */
(() => {
  "use strict";
  document.documentElement.classList.add("js");
  const FILTERED = 8; // rows, of which more have a field to filter by
  const PAGED = 500; // rows, of which more are shown a page at a time: laying out thousands takes seconds
  const make = (tag, properties, ...children) => {
    const element = Object.assign(document.createElement(tag), properties);
    element.append(...children);
    return element;
  };

  // Tables. What is missing comes last, whichever way a column is sorted.
  const bare = (cell) => String(cell ?? "").replace(/<[^>]*>/g, "");
  const collator = new Intl.Collator("en", { numeric: true });
  const missingLast = (gone, compare) => (a, b) => gone(a) - gone(b) || compare(a, b);
  const kinds = {
    number: [(cell) => (bare(cell) === "" ? NaN : Number(bare(cell))), Number.isNaN, (a, b) => (a < b ? -1 : Number(a > b))],
    text: [bare, (text) => text === "" || text === "\u2013", collator.compare],
  };
  for (const [name, [pre, gone, compare]] of Object.entries(kinds)) {
    const order = { pre, asc: missingLast(gone, compare), desc: missingLast(gone, (a, b) => compare(b, a)) };
    DataTable.type(name, { order, search: bare });
  }
  DataTable.ext.errMode = "throw";

  function group(table) {
    const heads = Number(table.dataset.heads) - 1;
    let above = [];
    for (const row of table.tBodies[0].rows) {
      if (row.cells.length <= heads) continue; // says that no row matches
      let same = above.length > 0;
      const own = [];
      for (let i = 0; i < heads; i++) {
        own.push(row.cells[i].textContent);
        same = same && own[i] === above[i];
        row.cells[i].classList.toggle("again", same);
        if (i === 0) row.classList.toggle("first", !same);
      }
      above = own;
    }
  }

  // As many of the heads stay, the last ones first, as leave room for what they name.
  function place(table) {
    const box = table.closest(".scroll");
    const heads = Number(table.dataset.heads);
    const widths = [...table.tHead.rows[0].cells].slice(0, heads).map((cell) => cell.getBoundingClientRect().width);
    let from = heads - 1;
    let width = widths[from];
    while (from > 0 && width + widths[from - 1] <= 0.65 * box.clientWidth) width += widths[--from];
    let left = 0;
    widths.forEach((own, i) => {
      table.style.setProperty(`--left-${i + 1}`, i < from ? "auto" : `${left}px`);
      if (i >= from) left += own;
    });
    box.classList.add("placed");
  }

  function sortable(table) {
    const box = table.closest(".scroll");
    const count = table.tBodies[0].rows.length;
    box.hidden = true; // nothing is laid out until all is done
    const api = new DataTable(table, {
      paging: count > PAGED, pageLength: PAGED / 2, info: false, autoWidth: false, order: [], orderClasses: false, typeDetect: false,
      layout: { topStart: null, topEnd: null, bottomStart: count > PAGED ? "paging" : null, bottomEnd: null },
      columns: [...table.tHead.rows[0].cells].map((cell) => ({
        type: cell.dataset.kind, orderSequence: ["asc", "desc", ""],
      })),
      language: { zeroRecords: "No row matches." },
    });
    box.hidden = false;
    api.on("draw", () => group(table));
    if (count > PAGED) group(table);
    if (count <= FILTERED) return;
    const field = make("input", { type: "search" });
    const shown = make("span", { className: "soft" });
    shown.setAttribute("role", "status");
    field.setAttribute("aria-describedby", table.caption.id);
    field.addEventListener("input", () => {
      api.search(field.value).draw();
      const left = api.rows({ search: "applied" }).count();
      shown.textContent = left === count ? "" : `${left} of ${count} rows`;
    });
    box.before(make("p", { className: "filter" }, make("label", {}, "Filter rows ", field), shown));
  }

  // The trials of a run come as lines of values.
  const field = /("(?:[^"]|"")*"|[^",]*)(,|$)/y;
  function values(line) {
    const cells = [];
    field.lastIndex = 0;
    for (let found; (found = field.exec(line)); ) {
      cells.push(found[1].replace(/^(-?)inf$/, "$1Infinity").replace(/^"|"$/g, "").replaceAll('""', '"'));
      if (found[2] === "") break;
    }
    return cells;
  }
  const rounded = (text) => (/^-?\d+$/.test(text) ? text : String(Number(Number(text).toPrecision(5))).replace("Infinity", "\u221e"));
  function tabulate(lines) {
    const [names, ...rows] = lines.textContent.trim().split("\n").map(values);
    const table = make("table", {}, make("caption", { id: "trials-caption" }, make("span", {}, lines.dataset.caption)));
    table.dataset.heads = 1;
    table.dataset.sortable = "";
    const head = table.createTHead().insertRow();
    const numbers = names.map((_, i) => rows.some((row) => row[i] !== "") && rows.every((row) => !Number.isNaN(Number(row[i]))));
    names.forEach((name, i) => {
      const cell = make("th", { scope: "col", className: i ? "" : "head own" }, name);
      cell.dataset.kind = numbers[i] ? "number" : "text";
      head.append(cell);
    });
    const body = table.createTBody();
    for (const row of rows) {
      const line = body.insertRow();
      row.forEach((value, i) => {
        const cell = i ? line.insertCell() : line.appendChild(make("th", { scope: "row", className: "head own" }));
        if (!numbers[i]) cell.classList.add("text");
        cell.textContent = value === "" ? "\u2013" : numbers[i] ? rounded(value) : value;
        if (numbers[i]) cell.dataset.order = value;
      });
    }
    const box = make("div", { className: rows.length > 30 ? "scroll long" : "scroll", tabIndex: 0 }, table);
    box.setAttribute("role", "region");
    box.setAttribute("aria-labelledby", "trials-caption");
    lines.replaceWith(box);
  }
  document.querySelectorAll("pre[data-caption]").forEach(tabulate);
  document.querySelectorAll("table[data-sortable]").forEach(sortable);
  const watch = new ResizeObserver((entries) => entries.forEach((entry) => place(entry.target.querySelector("table"))));
  document.querySelectorAll(".scroll").forEach((box) => watch.observe(box));

  // Figures.
  const dialog = make("dialog", {});
  dialog.setAttribute("aria-label", "Figure, enlarged");
  dialog.addEventListener("click", (event) => event.target === dialog && dialog.close());
  document.body.append(dialog);
  for (const picture of document.querySelectorAll("figure > img")) {
    const button = make("button", { type: "button", className: "enlarge" });
    picture.replaceWith(button);
    button.append(picture);
    button.setAttribute("aria-label", `Enlarge: ${picture.alt}`);
    button.addEventListener("click", () => {
      const close = make("form", { method: "dialog" }, make("button", { autofocus: true }, "Close"));
      const caption = button.parentElement.querySelector("figcaption").firstChild.textContent;
      dialog.replaceChildren(close, picture.cloneNode(), make("p", { className: "soft" }, caption));
      dialog.showModal();
    });
  }

  // The menu: folded on a phone, and the section in view is marked.
  const menu = document.querySelector(".menu details");
  if (!menu) return;
  const wide = matchMedia("(min-width: 62.5rem)");
  const fold = () => { menu.open = wide.matches; };
  wide.addEventListener("change", fold);
  fold();
  const links = new Map();
  for (const link of menu.querySelectorAll("a[href^='#']")) {
    const part = document.getElementById(link.hash.slice(1));
    if (part) links.set(part, link);
    link.addEventListener("click", () => { if (!wide.matches) menu.open = false; });
  }
  let marked = null;
  function mark() {
    const parts = [...links.keys()];
    const seen = parts.filter((part) => part.getBoundingClientRect().top <= innerHeight / 3);
    let part = seen.at(-1) ?? parts[0];
    const asked = location.hash && document.getElementById(location.hash.slice(1));
    if (innerHeight + scrollY >= document.documentElement.scrollHeight - 2) { // the last ones cannot reach the top
      part = links.has(asked) && asked.getBoundingClientRect().top >= 0 ? asked : parts.at(-1);
    }
    const link = links.get(part);
    if (!link || link === marked) return;
    marked?.removeAttribute("aria-current");
    link.setAttribute("aria-current", "true");
    marked = link;
    if (wide.matches) link.scrollIntoView({ block: "nearest", behavior: "instant" });
  }
  let waiting = false;
  const soon = () => {
    if (!waiting) requestAnimationFrame(() => { waiting = false; mark(); });
    waiting = true;
  };
  addEventListener("scroll", soon, { passive: true });
  addEventListener("resize", soon);
  addEventListener("hashchange", soon);
  mark();
})();

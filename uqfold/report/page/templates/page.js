"use strict";
// What readers can do with a report: switch colours, switch what is shown, sort and filter tables,
// read values off charts. The page is complete without it; every text here goes through textContent.
(() => {
  const root = document.documentElement;
  const all = (selector, within = document) => [...within.querySelectorAll(selector)];
  const make = (tag, properties = {}, children = []) => {
    const element = Object.assign(document.createElement(tag), properties);
    element.append(...children);
    return element;
  };
  const announce = (text) => { document.getElementById("announcement").textContent = text; };

  // Light, dark, or as the system says; kept where the browser allows it.
  const theme = document.getElementById("theme");
  const kept = (value) => {
    try {
      if (value === undefined) return localStorage.getItem("uqfold-theme");
      localStorage.setItem("uqfold-theme", value);
    } catch { /* a file opened from disk may have no storage */ }
    return null;
  };
  const wear = (name) => {
    if (name === "light" || name === "dark") root.dataset.theme = name; else delete root.dataset.theme;
    for (const button of theme.children) {
      button.setAttribute("aria-pressed", String(button.value === (root.dataset.theme ?? "auto")));
    }
  };
  theme.setAttribute("role", "group");
  theme.setAttribute("aria-label", "Colours");
  for (const [value, label] of [["auto", "Auto"], ["light", "Light"], ["dark", "Dark"]]) {
    const button = make("button", { type: "button", value, textContent: label });
    button.addEventListener("click", () => { kept(value); wear(value); });
    theme.append(button);
  }
  wear(kept());

  // Switches: one name is switched everywhere in the page.
  const off = new Set();
  const keyed = all("[data-keys]").map((element) => [element, element.dataset.keys.split("\n")]);
  const series = all(".series[data-key]");
  const showKeys = () => {
    for (const element of series) element.classList.toggle("off", off.has(element.dataset.key));
    for (const [element, keys] of keyed) {
      const hidden = keys.some((key) => off.has(key));
      if (element.tagName === "TR") element.dataset.off = hidden ? "1" : "";
      else element.hidden = hidden;
    }
    for (const element of series) element.style.display = element.classList.contains("off") ? "none" : "";
    for (const button of all("button.key")) button.setAttribute("aria-pressed", String(!off.has(button.dataset.key)));
    for (const refresh of tables) refresh();
  };
  const tables = [];
  for (const span of all("span.key[data-key]")) {
    const button = make("button", { type: "button", className: "key" }, [...span.childNodes]);
    button.dataset.key = span.dataset.key;
    button.setAttribute("aria-pressed", "true");
    button.addEventListener("click", () => {
      const key = button.dataset.key;
      if (!off.delete(key)) off.add(key);
      showKeys();
      announce(`${button.textContent.trim()} ${off.has(key) ? "hidden" : "shown"}`);
    });
    span.replaceWith(button);
  }
  if (document.querySelector(".controls")) root.classList.add("pinned");

  // Views: the same numbers on another axis.
  for (const figure of all("figure")) {
    const views = all(":scope > .view", figure);
    if (views.length < 2) continue;
    const bar = figure.querySelector(".views");
    bar.setAttribute("role", "group");
    bar.setAttribute("aria-label", bar.dataset.label);
    figure.classList.add("views-on");
    const show = (chosen) => views.forEach((view, i) => {
      view.hidden = view !== chosen;
      bar.children[i].setAttribute("aria-pressed", String(view === chosen));
    });
    for (const view of views) {
      const button = make("button", { type: "button", textContent: view.dataset.view });
      button.addEventListener("click", () => { show(view); announce(`Axis: ${view.dataset.view}`); });
      bar.append(button);
    }
    show(views[0]);
  }

  // Tables: sorted by a heading, filtered by words and by choices.
  const compare = (one, other) => {
    const [a, b] = [one, other].map((cell) => cell.dataset.sort);
    if (a === undefined && b === undefined) {
      return one.textContent.localeCompare(other.textContent, "en", { numeric: true });
    }
    return numeric(a) - numeric(b);
  };
  const numeric = (text) => (text === "inf" ? Infinity : text === "-inf" ? -Infinity : Number(text));
  const missing = (cell) => cell.dataset.sort === "";
  for (const table of all("table.tools")) {
    const body = table.tBodies[0], rows = [...body.rows];
    const heads = [...table.tHead.rows[0].cells];
    const caption = table.caption.textContent;
    heads.forEach((head, column) => {
      const button = make("button", { type: "button" }, [...head.childNodes]);
      head.append(button);
      button.addEventListener("click", () => {
        const rising = head.getAttribute("aria-sort") !== "ascending";
        for (const other of heads) other.removeAttribute("aria-sort");
        head.setAttribute("aria-sort", rising ? "ascending" : "descending");
        const cell = (row) => row.cells[column];
        const sorted = [...rows].sort((a, b) => {
          if (missing(cell(a)) || missing(cell(b))) return missing(cell(a)) - missing(cell(b));
          return (rising ? 1 : -1) * compare(cell(a), cell(b));
        });
        body.append(...sorted);
        announce(`${caption}: sorted by ${button.textContent}, ${rising ? "ascending" : "descending"}`);
      });
    });
    const choosers = [];
    const search = make("input", { type: "search", size: 16 });
    const count = make("span", { className: "count" });
    const tools = make("div", { className: "table-tools" }, [make("label", {}, ["Filter ", search])]);
    heads.forEach((head, column) => {
      if (head.dataset.choices === undefined) return;
      const values = [...new Set(rows.map((row) => row.cells[column].textContent))];
      if (values.length < 2) return;
      const options = ["all", ...values].map((value, i) => make("option", { value: i ? value : "", textContent: value }));
      const select = make("select", {}, options);
      choosers.push([column, select]);
      tools.append(make("label", {}, [`${head.textContent} `, select]));
      select.addEventListener("change", () => filter(true));
    });
    tools.append(count);
    const filter = (said) => {
      const words = search.value.toLowerCase().split(/\s+/).filter(Boolean);
      let shown = 0;
      for (const row of rows) {
        const text = row.textContent.toLowerCase();
        row.hidden = row.dataset.off === "1" || !words.every((word) => text.includes(word)) ||
          choosers.some(([column, select]) => select.value && row.cells[column].textContent !== select.value);
        shown += !row.hidden;
      }
      count.textContent = shown === rows.length ? `${rows.length} rows` : `${shown} of ${rows.length} rows`;
      if (said) announce(`${caption}: ${count.textContent}`);
    };
    search.addEventListener("input", () => filter(true));
    tables.push(() => filter(false));
    filter(false);
    if (rows.length > 12 || (choosers.length && rows.length > 4)) table.parentElement.before(tools);
  }

  // Scrolling areas can be reached by keyboard.
  const reach = () => {
    for (const area of all(".scroll, .equation")) {
      if (area.scrollWidth <= area.clientWidth) continue;
      area.tabIndex = 0;
      area.setAttribute("role", "group");
      area.setAttribute("aria-label", area.querySelector("caption")?.textContent ?? "Equation");
    }
  };
  reach();
  addEventListener("resize", reach);

  // Charts: values under the pointer, or one after the other by the arrow keys.
  const NAMESPACE = "http://www.w3.org/2000/svg";
  for (const plot of all(".plot")) {
    const svg = plot.querySelector("svg");
    const points = all("[data-at]", svg).map((element) => {
      const [x, y] = element.dataset.at.split(" ").map(Number);
      const title = element.querySelector("title");
      const text = title.textContent;
      title.remove();
      const series = element.closest(".series");
      return { x, y, series, label: series.dataset.label, text: `${series.dataset.label}\n${text}` };
    });
    if (!points.length) continue;
    const tip = make("div", { className: "tip", hidden: true });
    const halo = document.createElementNS(NAMESPACE, "circle");
    halo.setAttribute("class", "halo");
    halo.setAttribute("r", "8");
    plot.append(tip);
    plot.tabIndex = 0;
    plot.setAttribute("role", "group");
    plot.setAttribute("aria-label", `${svg.getAttribute("aria-label")} Arrow keys read the points one by one.`);
    let current = null;
    const visible = () => points.filter((point) => !point.series.classList.contains("off"));
    const clear = () => { current = null; tip.hidden = true; halo.remove(); };
    const show = (point, said) => {
      current = point;
      halo.setAttribute("cx", point.x);
      halo.setAttribute("cy", point.y);
      svg.append(halo);
      const near = (other) => other !== point && Math.hypot(other.x - point.x, other.y - point.y) < 4;
      const others = new Set(visible().filter(near).map((other) => other.label));
      others.delete(point.label);
      tip.textContent = others.size ? `${point.text}\nalso here: ${[...others].join(", ")}` : point.text;
      tip.hidden = false;
      const scale = svg.clientWidth / svg.viewBox.baseVal.width;
      const left = point.x * scale + 12, top = point.y * scale + 12;
      tip.style.left = `${Math.max(0, left + tip.offsetWidth > plot.clientWidth ? left - tip.offsetWidth - 24 : left)}px`;
      tip.style.top = `${top + tip.offsetHeight > plot.clientHeight ? top - tip.offsetHeight - 24 : top}px`;
      if (said) announce(point.text.replaceAll("\n", ", "));
    };
    plot.addEventListener("pointermove", (event) => {
      const box = svg.getBoundingClientRect();
      const scale = svg.viewBox.baseVal.width / box.width;
      const [x, y] = [(event.clientX - box.left) * scale, (event.clientY - box.top) * scale];
      const distance = (point) => Math.hypot(point.x - x, point.y - y);
      const nearest = visible().reduce((best, point) => (!best || distance(point) < distance(best) ? point : best), null);
      if (nearest && distance(nearest) < 28) { if (nearest !== current) show(nearest, false); } else clear();
    });
    plot.addEventListener("pointerleave", clear);
    plot.addEventListener("blur", clear);
    plot.addEventListener("keydown", (event) => {
      const shown = visible();
      if (!shown.length) return;
      const groups = [...new Set(shown.map((point) => point.series))];
      const own = shown.filter((point) => point.series === (current?.series ?? groups[0]));
      const place = own.indexOf(current), group = groups.indexOf(current?.series);
      const step = (list, at, by) => list[(at + by + list.length) % list.length];
      let next = null;
      if (event.key === "ArrowRight") next = current ? step(own, place, 1) : own[0];
      else if (event.key === "ArrowLeft") next = current ? step(own, place, -1) : own.at(-1);
      else if (event.key === "Home") next = own[0];
      else if (event.key === "End") next = own.at(-1);
      else if (event.key === "ArrowDown" || event.key === "ArrowUp") {
        const other = current ? step(groups, group, event.key === "ArrowDown" ? 1 : -1) : groups[0];
        const others = shown.filter((point) => point.series === other);
        const near = (point) => Math.abs(point.x - (current?.x ?? 0));
        next = others.reduce((best, point) => (near(point) < near(best) ? point : best));
      } else if (event.key === "Escape") { clear(); return; }
      if (!next) return;
      event.preventDefault();
      show(next, true);
    });
  }

  addEventListener("beforeprint", () => { for (const one of all("details:not(.values)")) one.open = true; });
})();

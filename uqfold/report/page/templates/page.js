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

  // Switches: what belongs to a method or criterion is switched everywhere in the page, other
  // series in their own figure.
  const tables = [], off = new Set();
  const owned = all("[data-gid]").map((element) => {
    const place = element.closest("figure")?.id ?? "";
    const parts = element.dataset.gid.split(";").map((part) => {
      const [kind, name] = [part.slice(0, part.indexOf("=")), part.slice(part.indexOf("=") + 1)];
      const shared = kind === "method" || kind === "criterion";
      return { kind, name, place: shared ? "" : place, key: `${shared ? "" : place}\n${kind}\n${name}` };
    });
    return { element, parts };
  });
  const colorOf = (element) => {
    const drawn = element.querySelector("use, path");
    const color = ["stroke", "fill"].map((name) => drawn?.getAttribute(name)).find((value) => value && value !== "none");
    return color ?? "";
  };
  const colors = new Map();
  for (const { element, parts } of owned) {
    const key = parts[0].key;
    if (element.tagName === "g" && !colors.get(key)) colors.set(key, colorOf(element));
  }
  const swatch = (key) => {
    const dot = make("span", { className: "swatch" });
    dot.style.setProperty("--c", colors.get(key));
    return dot;
  };
  const apply = () => {
    for (const { element, parts } of owned) {
      const hidden = parts.some((part) => off.has(part.key));
      if (element.tagName === "TR") element.dataset.off = hidden ? "1" : "";
      else element.classList.toggle("off", hidden);
    }
    for (const button of all("button.key")) button.setAttribute("aria-pressed", String(!off.has(button.value)));
    for (const refresh of tables) refresh();
  };
  const group = (kind, place) => {
    const found = new Map();
    for (const { parts } of owned) {
      for (const part of parts) if (part.kind === kind && part.place === place) found.set(part.key, part.name);
    }
    if (found.size < 2) return null;
    const keys = [...found].map(([key, name]) => {
      const button = make("button", { type: "button", className: "key", value: key },
        [...(colors.get(key) ? [swatch(key)] : []), name]);
      button.setAttribute("aria-pressed", "true");
      button.addEventListener("click", () => {
        if (!off.delete(key)) off.add(key);
        apply();
        announce(`${name} ${off.has(key) ? "hidden" : "shown"}`);
      });
      return make("li", {}, [button]);
    });
    const title = { method: "Methods", criterion: "Criteria" }[kind] ?? "Shown";
    const list = make("ul", { className: "keys" }, keys);
    list.setAttribute("aria-label", title);
    return make("div", { className: "group" }, [make("span", { className: "group-title", textContent: title }), list]);
  };
  const groups = ["method", "criterion"].map((kind) => group(kind, "")).filter(Boolean);
  if (groups.length) {
    const bar = make("div", { className: "controls" }, groups);
    bar.setAttribute("role", "group");
    bar.setAttribute("aria-label", "Shown on this page");
    document.getElementById("switches").replaceWith(bar);
    root.classList.add("pinned");
  }
  for (const figure of all("figure")) {
    const kinds = new Set(owned.flatMap(({ parts }) => parts.filter((part) => part.place === figure.id).map((part) => part.kind)));
    for (const kind of kinds) {
      const bar = group(kind, figure.id);
      if (bar) figure.querySelector(".plot").after(bar);
    }
  }
  for (const { element, parts } of owned) {
    if (element.tagName === "TR" && colors.get(parts[0].key)) element.cells[0].prepend(swatch(parts[0].key));
  }

  const MOST_CHOICES = 15;
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
    let leading = true;
    const search = make("input", { type: "search", size: 16 });
    const count = make("span", { className: "count" });
    const tools = make("div", { className: "table-tools" }, [make("label", {}, ["Filter ", search])]);
    heads.forEach((head, column) => {
      const values = [...new Set(rows.map((row) => row.cells[column].textContent))];
      // what was asked stands before the first column of answers
      if (values.length < 2 || values.length > MOST_CHOICES || 2 * values.length > rows.length) {
        leading = leading && values.length < 2;
        return;
      }
      if (head.classList.contains("number") && !leading) return;
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
    if (rows.length > 12 || (choosers.length && rows.length > 8)) table.parentElement.before(tools);
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

  // Figures: values under the pointer, or one after the other by the arrow keys.
  const NAMESPACE = "http://www.w3.org/2000/svg";
  for (const plot of all(".plot")) {
    const svg = plot.querySelector("svg");
    const points = all("use > title", svg).map((title) => {
      const mark = title.parentElement, series = mark.closest("[data-gid]");
      const label = series.dataset.gid.split(";").map((part) => part.slice(part.indexOf("=") + 1))[0];
      const text = `${label}\n${title.textContent}`;
      title.remove();
      return { x: Number(mark.getAttribute("x")), y: Number(mark.getAttribute("y")), series, label, text };
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
    let current = null, wanted = 0;
    const visible = () => points.filter((point) => !point.series.closest(".off"));
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
        // the place is kept on the way through other panels
        const near = (point) => Math.abs(point.x - wanted);
        next = others.reduce((best, point) => (near(point) < near(best) ? point : best));
      } else if (event.key === "Escape") { clear(); return; }
      if (!next) return;
      event.preventDefault();
      if (!event.key.match(/Up|Down/)) wanted = next.x;
      show(next, true);
    });
  }

  addEventListener("beforeprint", () => { for (const one of all("details:not(.values)")) one.open = true; });
})();

"use strict";
// Sort a table by a column. Rows move only inside their own group, so an infeasible method never rises above a feasible one.
const number = (text) => {
  const found = /^[+≈≥]?\s*([-−]?[\d\s.,]*\d(?:e[-+]?\d+)?)\s*(%|s|ms|µs|ns)?$/.exec(text);
  return found ? Number(found[1].replace("−", "-").replace(/[\s,]/g, "")) * ({ ms: 1e-3, "µs": 1e-6, ns: 1e-9 }[found[2]] ?? 1) : NaN;
};
for (const table of document.querySelectorAll("table:has(th[data-sort])")) {
  const heads = [...table.tHead.rows[0].cells];
  const said = document.createElement("p");
  said.className = "note";
  said.setAttribute("role", "status");
  table.parentElement.after(said);
  const value = (row, index) => (row.cells[index].dataset.value ?? row.cells[index].textContent.trim()).replace(/^–$/, "");
  const sortBy = (head, index) => {
    const down = head.getAttribute("aria-sort") === "ascending";
    for (const other of heads) if (other.hasAttribute("aria-sort")) other.setAttribute("aria-sort", "none");
    head.setAttribute("aria-sort", down ? "descending" : "ascending");
    const groups = [...table.tBodies].map((body) => [body, [...body.rows].filter((row) => !row.classList.contains("group"))]);
    const numeric = groups.every(([, rows]) => rows.every((row) => value(row, index) === "" || !isNaN(number(value(row, index)))));
    const order = (x, y) => {
      const a = value(x, index), b = value(y, index);
      if (a === "" || b === "") return (a === "") - (b === "");
      return (down ? -1 : 1) * (numeric ? number(a) - number(b) : a.localeCompare(b, "en", { numeric: true }));
    };
    for (const [body, rows] of groups) body.append(...rows.sort(order));
    said.textContent = `Sorted by ${head.textContent.trim()}, ${down ? "descending" : "ascending"}${table.querySelector("tbody.feasible") ? ", feasible methods first" : ""}.`;
  };
  heads.forEach((head, index) => {
    if (!head.hasAttribute("data-sort")) return;
    const button = document.createElement("button");
    button.type = "button";
    button.append(...head.childNodes);
    head.append(button);
    head.setAttribute("aria-sort", "none");
    button.addEventListener("click", () => sortBy(head, index));
  });
}

"use strict";
// Sort a table by a column. Rows move only inside their own group, so an infeasible method never rises above a feasible one.
for (const table of document.querySelectorAll("table.sortable")) {
  const heads = [...table.tHead.rows[0].cells];
  const said = document.createElement("p");
  said.className = "note";
  said.setAttribute("role", "status");
  table.parentElement.after(said);
  const value = (row, index) => row.cells[index].dataset.value ?? row.cells[index].textContent.trim();
  const compare = (a, b) => {
    if (a === "" || b === "") return (a === "") - (b === "");
    return a.localeCompare(b, "en", { numeric: true });
  };
  const sortBy = (head, index) => {
    const down = head.getAttribute("aria-sort") === "ascending";
    for (const other of heads) if (other.hasAttribute("aria-sort")) other.setAttribute("aria-sort", "none");
    head.setAttribute("aria-sort", down ? "descending" : "ascending");
    const numeric = head.classList.contains("num");
    for (const body of table.tBodies) {
      const rows = [...body.rows].filter((row) => !row.classList.contains("group"));
      const order = (x, y) => {
        const a = value(x, index), b = value(y, index);
        if (a === "" || b === "") return (a === "") - (b === "");
        const sign = down ? -1 : 1;
        return sign * (numeric ? Number(a) - Number(b) : compare(a, b));
      };
      body.append(...rows.sort(order));
    }
    said.textContent = `Sorted by ${head.textContent.trim()}, ${down ? "descending" : "ascending"}, feasible methods first.`;
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

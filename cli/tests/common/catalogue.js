// The user's actions on the page, and what it shows after each one.
const steps = [];
const look = (name) => steps.push([name, [...document.querySelectorAll("tbody tr")].map((row) => row.cells[0].firstChild.textContent),
  document.querySelector("#count").textContent, location.hash]);
const search = document.querySelector("#search");
const type = (text) => { search.value = text; search.dispatchEvent(new Event("input", { bubbles: true })); look(text); };
const press = (sort) => { document.querySelector(`[data-sort=${sort}]`).click(); look(sort); };
look("opened");
type("SMOOTH mit");
type("cc0 sbeta");
type("</" + "script>");
type("no such thing");
type("");
press("bytes");
press("bytes");
press("name");
document.querySelector("#left-out").click();
look("left out");
document.querySelector("#left-out").click();
const play = document.querySelector("button.play");
play.click();
await new Promise((done) => setTimeout(done, 500));
steps.push(["played", play.textContent]);
const result = document.createElement("pre");
result.id = "result";
result.textContent = encodeURIComponent(JSON.stringify(steps));
document.body.append(result);

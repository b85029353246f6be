import { StrictMode } from "react";
import { createRoot, hydrateRoot } from "react-dom/client";

import { App } from "./app";

const element = document.querySelector("#app");
if (!element) throw new Error("the page has no element with the id `app`");
const app = (
  <StrictMode>
    <App />
  </StrictMode>
);
// A server may already have rendered the page (`server.tsx`).
if (element.hasChildNodes()) hydrateRoot(element, app);
else createRoot(element).render(app);

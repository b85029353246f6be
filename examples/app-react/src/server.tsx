import { StrictMode } from "react";
import { renderToString } from "react-dom/server";

import { App } from "./app";

/** Returns the contents of the element `#app`. */
export const render = () =>
  renderToString(
    <StrictMode>
      <App />
    </StrictMode>,
  );

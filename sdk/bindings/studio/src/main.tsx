// The page begins.

import { render } from "preact";

import "./styles/base.css";
import "./styles/frame.css";
import "./styles/lamp.css";
import "./styles/controls.css";
import "./styles/screens.css";
import "./styles/shape.css";
import "./styles/save.css";
import "./styles/knobs.css";
import "./styles/versions.css";
import "./styles/qr.css";
import "./styles/windows.css";
import { App } from "./app.tsx";
import { start } from "./start.ts";

const place = document.getElementById("app");
if (place) render(<App />, place);
start();

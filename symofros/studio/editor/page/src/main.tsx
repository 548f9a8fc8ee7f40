import "./style/tokens.css";
import "./style/controls.css";
import "./style/shell.css";
import "./style/canvas.css";
import "./style/diagram.css";
import "./style/runs.css";
import "./style/windows.css";
import "./style/panels.css";

import { createRoot } from "react-dom/client";

import { App } from "./App";
import { begin } from "./store/session";

void begin();
createRoot(window.document.getElementById("root") as HTMLElement).render(<App />);

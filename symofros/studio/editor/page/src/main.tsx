import "./style/tokens.css";
import "./style/controls.css";
import "./style/shell.css";
import "./style/canvas.css";
import "./style/diagram.css";
import "./style/runs.css";
import "./style/tree.css";
import "./style/windows.css";
import "./style/consent.css";
import "./style/guide.css";
import "./style/panels.css";
import "./style/narrow.css";

import { createRoot } from "react-dom/client";

import { App } from "./App";
import { begin } from "./store/session";
import { update } from "./store/store";

// Where there is little room the diagram has it; panes open when they are asked for.
if (window.innerWidth < 900) update({ right: null });
void begin();
createRoot(window.document.getElementById("root") as HTMLElement).render(<App />);

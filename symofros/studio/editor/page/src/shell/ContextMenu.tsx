import { useCallback } from "react";

import { commandsFor } from "../canvas/commands";
import { update, useStore } from "../store/store";
import { MenuList } from "./Menu";

// What keeps the list within the window [px].
const ROOM = [280, 260] as const;

/** What can be done with what was pressed with the other button of the mouse. */
export function ContextMenu() {
  const menu = useStore((state) => state.menu);
  const close = useCallback(() => update({ menu: null }), []);
  if (menu === null) return null;
  const [x, y] = menu.at;
  const style = { left: Math.min(x, window.innerWidth - ROOM[0]), top: Math.min(y, window.innerHeight - ROOM[1]) };
  return (
    <aside aria-label="Commands" className="context-menu menu" style={style}>
      <MenuList title="What can be done here" items={commandsFor(menu.id, menu.where)} close={close} />
    </aside>
  );
}

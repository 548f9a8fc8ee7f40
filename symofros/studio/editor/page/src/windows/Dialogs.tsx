import { useStore } from "../store/store";
import { AnalyseForm } from "./AnalyseForm";
import { ConsentForm } from "./ConsentForm";
import { Examples } from "./Examples";
import { ExportForm } from "./ExportForm";
import { ChangedOnDisk, Discard, NewFile, OpenFile, SaveAs } from "./files";
import { Keys } from "./Keys";
import { LinkForm } from "./LinkForm";
import { PartForm } from "./PartForm";
import { Properties } from "./Properties";
import { RunForm } from "./RunForm";
import { SearchBox } from "./SearchBox";
import { SimulateForm } from "./SimulateForm";

/** The window that is open. */
export function Dialogs() {
  const dialog = useStore((state) => state.dialog);
  switch (dialog?.kind) {
    case undefined:
      return null;
    case "properties":
      return <Properties key={dialog.path.join("/")} path={dialog.path} entry={dialog.entry ?? []} />;
    case "open":
      return <OpenFile files={dialog.files} />;
    case "examples":
      return <Examples examples={dialog.examples} />;
    case "new":
      return <NewFile />;
    case "save as":
      return <SaveAs />;
    case "simulate":
      return <SimulateForm asked={dialog.asked} />;
    case "analyse":
      return <AnalyseForm asked={dialog.asked} state={dialog.state} />;
    case "run":
      return <RunForm />;
    case "consent":
      return <ConsentForm files={dialog.files} fault={dialog.fault} proceed={dialog.proceed} />;
    case "export":
      return <ExportForm />;
    case "save part":
      return <PartForm bodies={dialog.bodies} />;
    case "link":
      return <LinkForm first={dialog.first} second={dialog.second} />;
    case "discard":
      return <Discard proceed={dialog.proceed} />;
    case "changed on disk":
      return <ChangedOnDisk disk={dialog.disk} over={dialog.over} path={dialog.path} />;
    case "search":
      return <SearchBox />;
    case "keys":
      return <Keys />;
  }
}

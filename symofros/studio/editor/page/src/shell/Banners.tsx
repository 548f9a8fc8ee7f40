import { discard, refresh, reload, save } from "../store/files";
import { hush, update, useStore } from "../store/store";
import { IconButton } from "./IconButton";

/** What concerns the whole page: the server is gone, unsaved work was found. */
export function Banners() {
  const link = useStore((state) => state.link);
  const recovered = useStore((state) => state.document?.recovered === true);
  const unkept = useStore((state) => state.document?.unkept ?? null);
  const changed = useStore((state) => state.document?.disk_changed === true);
  const imported = useStore((state) => state.imported);
  return (
    <>
      {link === "lost" ? (
        <div className="banner bad" role="alert">
          <span>
            The server does not answer. Changes up to the last one are kept on disk; what you type now is kept here, and
            sent when it is back. Start it again with `symofros edit`.
          </span>
          <button type="button" className="small" onClick={() => void refresh()}>
            Try again
          </button>
        </div>
      ) : null}
      {link === "expired" ? (
        <div className="banner bad" role="alert">
          <span>The server was started anew, and gave a new address: open the one that it printed.</span>
        </div>
      ) : null}
      {unkept === null ? null : (
        <div className="banner bad" role="alert">
          <span>
            Unsaved work cannot be kept beside the file: {unkept.found}. {unkept.remedy}
          </span>
        </div>
      )}
      {changed ? (
        <div className="banner" role="status">
          <span>Somebody else has written the file. Saving will ask before it is overwritten.</span>
          <button type="button" className="small" onClick={() => void reload()}>
            Take the text on disk
          </button>
        </div>
      ) : null}
      {imported.length > 0 ? (
        <div className="banner" role="status">
          <span>The import left out or changed: {imported.join("; ")}.</span>
          <IconButton glyph="close" label="Close what the import says" onClick={() => update({ imported: [] })} />
        </div>
      ) : null}
      {recovered ? (
        <div className="banner" role="status">
          <span>Unsaved work of an earlier run was found, and is shown here.</span>
          <button type="button" className="small" onClick={() => void save()}>
            Save it
          </button>
          <button type="button" className="small" onClick={() => void discard()}>
            Back to the saved file
          </button>
        </div>
      ) : null}
    </>
  );
}

/** Refusals of the server, each until it is closed. */
export function Notices() {
  const notices = useStore((state) => state.notices);
  return (
    <div className="notices" role="log" aria-label="Notices">
      {notices.map(({ id, fault }) => (
        <div key={id} className="notice">
          <p>
            <b>{fault.object}</b>
            <br />
            found: {fault.found}
            <br />
            <span className="remedy">{fault.remedy}</span>
          </p>
          <IconButton glyph="close" label="Close this notice" onClick={() => hush(id)} />
        </div>
      ))}
    </div>
  );
}

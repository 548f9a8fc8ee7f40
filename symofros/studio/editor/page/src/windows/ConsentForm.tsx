import { useState } from "react";

import type { Fault, NativeFile } from "../api/types";
import { Foot } from "../shell/Foot";
import { Window } from "../shell/Window";
import { consent } from "../store/jobs";
import { dismiss, notify } from "../store/store";
import { DocsPage } from "./Help";

const size = (bytes: number): string =>
  bytes < 1 << 20 ? `${(bytes / 1024).toFixed(1)} KiB` : `${(bytes / (1 << 20)).toFixed(1)} MiB`;

const list = new Intl.ListFormat("en");

interface AskProps {
  file: NativeFile;
  isGiven: boolean;
  onChange(isGiven: boolean): void;
}

/** One file: what is known of it, and what it says of itself, which nobody has checked. */
function Ask({ file, isGiven, onChange }: AskProps) {
  const { path, blocks, bytes, digest, owner, model, author, tool } = file;
  const name = path.split("/").at(-1) ?? path;
  return (
    <section className="native-file">
      <h3>{name}</h3>
      <dl>
        <dt>File</dt>
        <dd>{path}</dd>
        <dt>{blocks.length === 1 ? "Block" : "Blocks"}</dt>
        <dd>{list.format(blocks)}</dd>
        <dt>Owner</dt>
        <dd>{owner}, on this machine</dd>
        <dt>Size</dt>
        <dd>{size(bytes)}</dd>
        <dt>SHA-256</dt>
        <dd className="digest">{digest}</dd>
        <dt>It states</dt>
        <dd>
          model {model || "without a name"}, by {author || "no author"}, written by {tool || "no program"} (nobody has
          checked this)
        </dd>
      </dl>
      <label>
        <input type="checkbox" checked={isGiven} onChange={(event) => onChange(event.target.checked)} />
        Run the native code of {name}
      </label>
    </section>
  );
}

interface Props {
  files: NativeFile[];
  /** Why the run was refused, which is said if it stays refused. */
  fault: Fault;
  proceed(): void;
}

/** Asks, file by file, whether a diagram may run native code. */
export function ConsentForm({ files, fault, proceed }: Props) {
  const [given, setGiven] = useState<readonly string[]>([]);
  const toggle = (path: string, isGiven: boolean): void =>
    setGiven(isGiven ? [...given, path] : given.filter((other) => other !== path));
  const isAll = files.every(({ path }) => given.includes(path));
  const refuse = (): void => {
    dismiss();
    notify(fault);
  };
  const start = async (): Promise<void> => {
    if (!isAll) return;
    dismiss();
    if (await consent(files)) proceed();
  };
  return (
    <Window
      title="Run native code?"
      wide
      onClose={refuse}
      onSubmit={() => void start()}
      foot={<Foot word="Run" disabled={!isAll} onCancel={refuse} />}
    >
      <p>
        This diagram runs compiled code that {files.length === 1 ? "a file brings" : "files bring"} along. Native code
        can do all that you can: read, change and send your files. It runs in a process of its own, bounded in time and
        memory, but not kept from your files. Consent only if you trust who made it.
      </p>
      {files.map((file) => (
        <Ask
          key={file.path}
          file={file}
          isGiven={given.includes(file.path)}
          onChange={(isGiven) => toggle(file.path, isGiven)}
        />
      ))}
      <p className="quiet">
        Your consent holds for these bytes, until the editor's server ends; a file that changes is asked for again.
      </p>
      <DocsPage page="docs/howto/fmu.md" />
    </Window>
  );
}

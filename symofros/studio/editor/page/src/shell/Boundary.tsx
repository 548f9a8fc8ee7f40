import { Component, type ReactNode } from "react";

import { saveText } from "../files/choose";
import { now, update } from "../store/store";

interface Props {
  /** What it is around, in words. */
  what: string;
  /** When this changes, another attempt is made. */
  attempt: unknown;
  children: ReactNode;
}

interface State {
  failure: unknown;
  attempt: unknown;
}

/**
 * What is shown in place of a part of the page that can't be drawn: why, and ways on.
 *
 * The rest of the page stays, and so does the document: the server has it, with every edit that it was sent.
 */
export class Boundary extends Component<Props, State> {
  override state: State = { failure: null, attempt: this.props.attempt };

  static getDerivedStateFromError(failure: unknown): Partial<State> {
    return { failure: failure ?? "unknown" };
  }

  static getDerivedStateFromProps({ attempt }: Props, state: State): Partial<State> | null {
    return attempt === state.attempt ? null : { failure: null, attempt };
  }

  override render(): ReactNode {
    const { failure } = this.state;
    if (failure === null) return this.props.children;
    return <Failed what={this.props.what} failure={failure} again={() => this.setState({ failure: null })} />;
  }
}

export const reasonOf = (failure: unknown): string =>
  failure instanceof Error ? `${failure.name}: ${failure.message}` : String(failure);

function Failed({ what, failure, again }: { what: string; failure: unknown; again(): void }) {
  const document = now().document;
  return (
    <div className="failed" role="alert">
      <p>
        <b>{what} can&apos;t be shown.</b> This is a fault of the page, not of what you did; nothing is lost: the server
        keeps the document.
      </p>
      <p>
        found: <code>{reasonOf(failure)}</code>
      </p>
      <div className="failed-ways">
        <button type="button" onClick={again}>
          Try again
        </button>
        <button type="button" onClick={() => window.location.reload()}>
          Reload the page
        </button>
        {document === null ? null : (
          <>
            <button type="button" onClick={() => update({ right: "text", dialog: null })}>
              Show the text
            </button>
            <button type="button" onClick={() => saveText(document)}>
              Download the text
            </button>
          </>
        )}
      </div>
    </div>
  );
}

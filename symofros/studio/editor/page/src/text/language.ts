import { yamlLanguage } from "@codemirror/lang-yaml";
import { Language, LanguageSupport } from "@codemirror/language";
import { type Input, Parser, type PartialParse, Tree, type TreeFragment } from "@lezer/common";

/** Text nested deeper than this gets no syntax tree: building and reading one recurses, and exhausts the stack. */
const DEEPEST = 200;

/** An upper bound of the depth: brackets that are open, and the width of what indents a line or starts its items. */
function isTooDeep(text: string): boolean {
  let open = 0;
  let indented = 0;
  let isLineStart = true;
  for (const each of text) {
    if (each === "\n") {
      indented = 0;
      isLineStart = true;
    } else if (isLineStart && " -?:".includes(each)) indented++;
    else isLineStart = false;
    if (each === "[" || each === "{") open++;
    else if (each === "]" || each === "}") open = Math.max(0, open - 1);
    if (open + indented > DEEPEST) return true;
  }
  return false;
}

class BoundedParser extends Parser {
  createParse(input: Input, fragments: readonly TreeFragment[], ranges: readonly { from: number; to: number }[]) {
    if (isTooDeep(input.read(0, input.length))) return withoutSyntax(input.length);
    const parsed = fragments.filter(({ tree }) => tree.children.length > 0);
    return yamlLanguage.parser.createParse(input, parsed, ranges);
  }
}

function withoutSyntax(length: number): PartialParse {
  return {
    parsedPos: length,
    stoppedAt: null,
    stopAt: () => undefined,
    advance: () => new Tree(yamlLanguage.parser.topNode, [], [], length),
  };
}

const bounded = new Language(yamlLanguage.data, new BoundedParser(), [], "yaml");

/** YAML of any depth. */
export const yaml = (): LanguageSupport => new LanguageSupport(bounded);

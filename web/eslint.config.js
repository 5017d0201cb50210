import { dirname, resolve } from "node:path";
import { fileURLToPath } from "node:url";
import js from "@eslint/js";
import hooks from "eslint-plugin-react-hooks";
import tseslint from "typescript-eslint";

const web = dirname(fileURLToPath(import.meta.url));

/** Imports run one way: model ← net ← editor ← view. A room may not import what stands to its right; the types that the service's
 * OpenAPI document gives (net/schema.d.ts) are below all of them. */
const walls = (room, forbidden) => ({
  files: [`web/src/${room}/**/*.{ts,tsx}`],
  rules: {
    "no-restricted-imports": [
      "error",
      {
        patterns: [
          {
            regex: `^(@|\\.\\.)/(${forbidden.join("|")})(/|$)`,
            message: `${room} imports none of ${forbidden.join(", ")}.`,
          },
        ],
      },
    ],
  },
});

export default tseslint.config(
  { ignores: ["web/src/net/schema.d.ts", "web/src/model/settings.gen.ts"] },
  js.configs.recommended,
  ...tseslint.configs.strictTypeChecked,
  ...tseslint.configs.stylisticTypeChecked,
  {
    languageOptions: { parserOptions: { project: resolve(web, "tsconfig.json") } },
    plugins: { "react-hooks": hooks },
    rules: {
      "react-hooks/rules-of-hooks": "error",
      "react-hooks/exhaustive-deps": "error",
      "@typescript-eslint/restrict-template-expressions": ["error", { allowNumber: true }],
      "@typescript-eslint/consistent-type-imports": "error",
      "@typescript-eslint/explicit-module-boundary-types": "error",
      "max-lines": ["error", { max: 300, skipBlankLines: true, skipComments: true }],
      "max-lines-per-function": ["error", { max: 50, skipBlankLines: true, skipComments: true }],
      eqeqeq: "error",
    },
  },
  {
    // Markup is read down the page: an element with its attributes takes many lines and says little in each.
    files: ["web/src/view/**/*.tsx"],
    rules: { "max-lines-per-function": ["error", { max: 65, skipBlankLines: true, skipComments: true }] },
  },
  walls("model", ["net(?!/schema$)", "editor", "view"]),
  walls("net", ["editor", "view"]),
  walls("editor", ["view"]),
  {
    // The model is arithmetic and state: it must run without a browser.
    files: ["web/src/model/**/*.ts"],
    rules: {
      "no-restricted-globals": ["error", "document", "window", "fetch", "localStorage", "navigator", "XMLHttpRequest"],
    },
  },
);

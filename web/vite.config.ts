import { fileURLToPath } from "node:url";
import { defineConfig } from "vitest/config";

const here = (path: string): string => fileURLToPath(new URL(path, import.meta.url));

/** Where `npm run dev` finds the service. The built page is served by the service itself. */
const service = process.env.PULLFOCUS_SERVICE ?? "http://127.0.0.1:8000";

export default defineConfig({
  root: here("."),
  resolve: { alias: { "@": here("./src") } },
  build: {
    outDir: here("../service/static"),
    emptyOutDir: true,
    target: "es2022",
    assetsInlineLimit: 0,
  },
  server: {
    proxy: { "/v1": { target: service, ws: true } },
    fs: { allow: [here("..")] },
  },
  test: {
    // The tests live beside those of the other rooms; without imports of `vitest` they need no node_modules there.
    dir: here("../tests/web"),
    include: ["**/*.test.ts"],
    globals: true,
    environment: "node",
  },
});

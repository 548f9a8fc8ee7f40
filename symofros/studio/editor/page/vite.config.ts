import react from "@vitejs/plugin-react";
import { defineConfig } from "vitest/config";

// The build is committed (symofros/studio/editor/static) and must come out the same everywhere: names of files by content, no dates, no paths.
export default defineConfig({
  base: "./",
  plugins: [react()],
  build: {
    outDir: "../static",
    emptyOutDir: true,
    target: "es2022",
    sourcemap: false,
    reportCompressedSize: false,
    license: { fileName: "licenses.md" },
    chunkSizeWarningLimit: 1000,
  },
  test: { include: ["test/**/*.test.ts"] },
});

import { defineConfig } from "vite";

// Names below assets/ hold a hash of the content: visumd lets browsers keep them
// (server/gateway/page_files.cc).
export default defineConfig({
  base: "./",
  build: { target: "es2022", assetsInlineLimit: 0, modulePreload: { polyfill: false }, chunkSizeWarningLimit: 2000 },
});

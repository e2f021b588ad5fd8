// Makes src/.generated/visum_pb.ts from the protocol's messages: protoc, with the plugin that
// package-lock.json fixes.
import { execFileSync } from "node:child_process";
import { mkdirSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const page = dirname(dirname(fileURLToPath(import.meta.url)));
const protocol = join(page, "../../protocol");
const out = join(page, "src/.generated");
mkdirSync(out, { recursive: true });
execFileSync(
  "protoc",
  [
    `--plugin=protoc-gen-es=${join(page, "node_modules/.bin/protoc-gen-es")}`,
    `--proto_path=${protocol}`,
    `--es_out=${out}`,
    "--es_opt=target=ts",
    "visum.proto",
  ],
  { stdio: "inherit" },
);

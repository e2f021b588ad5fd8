// Saves files to the user's disk, and loads them from there.

export function download(name: string, blob: Blob): void {
  const url = URL.createObjectURL(blob);
  const link = document.createElement("a");
  link.href = url;
  link.download = name.replaceAll(/[/\\:*?"<>|]/g, "_");
  link.click();
  setTimeout(() => URL.revokeObjectURL(url), 1000);
}

export function pickText(accept: string): Promise<string> {
  const input = document.createElement("input");
  input.type = "file";
  input.accept = accept;
  return new Promise((resolve, reject) => {
    input.addEventListener("change", () => {
      const file = input.files?.[0];
      if (file) file.text().then(resolve, reject);
    });
    input.click();
  });
}

// Lets the user choose a folder. Resolves to its files, with their paths from the folder's name on. It stays
// open for ever where the user chooses none, as browsers tell nobody.
export function pickFolder(): Promise<{ path: string; file: File }[]> {
  const input = document.createElement("input");
  input.type = "file";
  input.webkitdirectory = true;
  return new Promise((resolve) => {
    input.addEventListener("change", () => resolve([...(input.files ?? [])].map((file) => ({ path: file.webkitRelativePath, file }))));
    input.click();
  });
}

// Opens files in the page as a user does: by the button, or by dropping them.

const asFile = (name, text) => ({ name, mimeType: "text/plain", buffer: Buffer.from(text) });

/// Chooses files by the panel's button.
export async function choose(page, files, click = (button) => button.click()) {
  const chooser = page.waitForEvent("filechooser");
  await click(page.getByRole("button", { name: "Open files" }));
  await (await chooser).setFiles(files.map(([name, text]) => asFile(name, text)));
  const dialog = page.getByRole("dialog", { name: /^Open/ });
  await dialog.waitFor();
  return dialog;
}
/// Lets files hang over the page, and drops them, as a file manager would.
export const drag = (page, kinds, files) =>
  page.evaluate(
    ({ kinds, files }) => {
      const dataTransfer = new DataTransfer();
      for (const [name, text] of files) dataTransfer.items.add(new File([text], name));
      for (const kind of kinds)
        document.body.dispatchEvent(new DragEvent(kind, { dataTransfer, bubbles: true, cancelable: true }));
    },
    { kinds, files },
  );

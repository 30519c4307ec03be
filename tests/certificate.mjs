// A certificate for localhost and its key, made for a test.
import { spawnSync } from "node:child_process";
import { join } from "node:path";

/// Writes key.pem and certificate.pem into the folder. `made` is false if there is no openssl.
export function makeCertificate(folder) {
  const [key, certificate] = ["key.pem", "certificate.pem"].map((name) => join(folder, name));
  const request = ["req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "2", "-subj", "/CN=localhost"];
  const { error, status, stderr } = spawnSync("openssl", [...request, "-keyout", key, "-out", certificate]);
  if (!error && status !== 0) throw new Error(`openssl made no certificate: ${stderr}`);
  return { key, certificate, made: !error };
}

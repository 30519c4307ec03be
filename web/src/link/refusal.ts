// Why the server would refuse the page a connection now: browsers do not tell the page what a handshake was answered.

const patience = 5000; // [ms]

/// The server's reason; "" if there is none, or no server.
export async function refusalOf(session: string): Promise<string> {
  try {
    const answer = await fetch(`/ws?session=${encodeURIComponent(session)}`, {
      cache: "no-store",
      signal: AbortSignal.timeout(patience),
    });
    // 426: it would connect now. A proxy's own answer is a page.
    const isReason =
      [400, 403, 503].includes(answer.status) && answer.headers.get("content-type")?.startsWith("text/plain");
    return isReason ? (await answer.text()).trim().slice(0, 300) : "";
  } catch {
    return "";
  }
}

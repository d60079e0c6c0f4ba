// The list of models: two are picked, and a session of them is started and shown in this window.
"use strict";
(() => {
  const element = (id) => document.getElementById(id);
  const picked = (name) => document.querySelector(`input[name=${name}]:checked`)?.value;

  function list(id, names, first) {
    names.forEach((text, i) => {
      const line = document.createElement("label"), choice = document.createElement("input");
      Object.assign(choice, { type: "radio", name: id, value: String(i), checked: i === first });
      line.append(choice, text);
      element(id).append(line);
    });
  }

  function say(text, bad) {
    element("gallery-state").textContent = text;
    element("gallery-state").style.color = bad ? "var(--late)" : "";
  }

  async function follow() {
    for (;;) {
      const now = await asperity.loadSession();
      element("leave").hidden = now.phase === "idle";
      element("touch").disabled = now.phase === "starting";
      if (now.phase === "idle") { say(now.trouble === "" ? "" : `The session ended: ${now.trouble}`, true); return; }
      say(now.phase === "starting" ? "The session starts \u2026" : "");
      if (now.phase === "running" && /^http:\/\/(127\.|\[::1\])/.test(now.url)) { location.href = now.url; return; }
      await new Promise((later) => setTimeout(later, 150));
    }
  }

  const trouble = (why) => say(`The gallery does not answer (${why.message}).`, true);

  // Whoever comes here, also by the back button, is in no session.
  async function arrive() {
    await asperity.tell("leave");
    await follow();
  }

  asperity.openGallery = (description) => {
    element("gallery").hidden = false;
    element("state").textContent = `${description.listed.length} models`;
    list("probes", description.listed, 0);
    list("bodies", description.listed, Math.min(1, description.listed.length - 1));
    element("touch").addEventListener("click", async () => {
      await asperity.tell(`touch=${picked("probes")},${picked("bodies")}`);
      follow().catch(trouble);
    });
    element("leave").addEventListener("click", () => arrive().catch(trouble));
    window.addEventListener("pageshow", (e) => { if (e.persisted) arrive().catch(trouble); });
    arrive().catch(trouble);
  };
})();

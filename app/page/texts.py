"""The words of help and tour. They are the program's own: nothing that a user or a file can write is among them."""

from __future__ import annotations

from typing import Any

TABS = ("Rules", "Membership", "Inference", "Files", "Plots", "Metrics", "Why")
"""The tabs that keys 1, 2, ... open: those of Design, then those of Response."""

KEYS = (
    ("Space", "play or pause"),
    ("← →", "one step of 10 ms back or on, standing still"),
    ("R", "begin anew"),
    ("K", "keep the present run as a baseline to compare with"),
    ("Ctrl+Z, Ctrl+Shift+Z", "undo, redo: 200 steps; everybody shares one document"),
    ("Ctrl+S", "save the rule base"),
    ("1 2 3 4", "Rules, Membership, Inference, Files"),
    ("5 6 7", "Plots, Metrics, Why"),
    ("Ctrl+K", "all commands, to search"),
    ("?", "this help; Esc closes it"),
)

GESTURES = (
    ("drag in the scene", "turn the view; with the right button shift it; the wheel comes nearer"),
    ("Shift + drag the arm", "pull it with a spring (live simulation only); the controller fights it"),
    ("click a cell or a tile", "paint it with the term of the brush"),
    ("drag a handle below a curve", "move the point of a term; the numbers below take exact values"),
    ("drag t [s]", "see the arm, the firing rules and the plots at that time"),
)

PANELS = (
    ("Rules", "the table e × de; glowing cells fire now, hatched ones never did in this run"),
    ("Membership", "the terms of each variable, its range and gain"),
    ("Inference", "how rules are combined and defuzzified, and each step of it in numbers"),
    ("Files", "new, open, save, upload, download, and the history of edits"),
    ("Run", "time, controller, scenario, arm; baselines, cameras, saving a run"),
    ("Plots", "coordinates over time; blue is now, dashed before the edit, orange PID, dotted the target"),
    ("Metrics", "overshoot, settling and more beside those before the edit and PID; robustness on random arms"),
    ("Why", "which rules make the output now, and which one to change against an overshoot"),
)

TOUR = (
    (
        "An arm that answers",
        "The arm hangs from its base and is asked to reach the pale one; then it begins anew. "
        "A fuzzy controller moves it, and you are about to edit that while it runs.",
        "",
    ),
    (
        "Design",
        "Here is the controller. Click a term of the first row, then a cell of the table: the arm follows at once. "
        "Glowing cells are the rules that fire at this moment.",
        "Rules",
    ),
    (
        "Run",
        "Pause with Space, drag t to look at any time, choose another scenario or disturbance. "
        "Hold Shift and drag the arm to pull it.",
        "Run",
    ),
    (
        "Response",
        "What your edit did: curves in Plots, figures in Metrics beside those before and those of PID. "
        "Why names the rule behind an overshoot.",
        "Plots",
    ),
    (
        "Nothing gets lost",
        "Ctrl+Z takes back any edit, Ctrl+S saves, and a crash keeps your work. Press ? for all keys and gestures.",
        "Files",
    ),
)
"""Title, text, and the tab or panel that is framed."""

CONTENT: dict[str, Any] = {
    "keys": KEYS,
    "gestures": GESTURES,
    "panels": PANELS,
    "tour": [{"title": title, "text": text, "panel": panel} for title, text, panel in TOUR],
}

"""Plugin of KiCad's PCB editor that imports a netlist as a user would, and records the resulting board.

The editor has no command and no Python function for this. So the plugin opens File > Import > Netlist, fills in the
dialog and presses its buttons. Environment variables: FINGERTIP_NETLIST (file to read) and FINGERTIP_RECORD (JSON file
to write).
"""

import json
import os
import sys
import traceback
from pathlib import Path

import pcbnew
import wx
import wx.html

STEP_MS = 200
MESSAGE_BOX_MS = 5000
MAX_STEPS = 600


def _menu_item(menu, label):
    for item in menu.GetMenuItems():
        if item.GetSubMenu():
            if found := _menu_item(item.GetSubMenu(), label):
                return found
        elif item.GetItemLabelText().startswith(label):
            return menu, item
    return None


def _descendants(window):
    yield window
    for child in window.GetChildren():
        yield from _descendants(child)


def _dialogs():
    return [w for w in wx.GetTopLevelWindows() if isinstance(w, wx.Dialog) and w.IsShown()]


def _press(dialog, label):
    button = next(w for w in _descendants(dialog) if isinstance(w, wx.Button) and w.GetLabel() == label)
    event = wx.CommandEvent(wx.wxEVT_BUTTON, button.GetId())
    event.SetEventObject(button)
    button.GetEventHandler().ProcessEvent(event)


def _messages(dialog):
    page = next(w for w in _descendants(dialog) if isinstance(w, wx.html.HtmlWindow))
    return page.ToText()


def _board():
    footprints = {}
    for footprint in pcbnew.GetBoard().GetFootprints():
        footprints[footprint.GetReference()] = {
            "value": footprint.GetValue(),
            "footprint": footprint.GetFPIDAsString(),
            "path": footprint.GetPath().AsString(),
            "nets": {pad.GetNumber(): pad.GetNetname() for pad in footprint.Pads()},
        }
    return footprints


def _finish(record):
    Path(os.environ["FINGERTIP_RECORD"]).write_text(json.dumps(record), encoding="utf-8")
    sys.stdout.flush()
    os._exit(0)  # a normal exit would ask whether to save


class _Import:
    """Import in steps, one whenever the editor is idle: wait for the window, open the dialog, fill it in, record."""

    def __init__(self):
        self.steps = 0
        self.is_open = False

    def step(self):
        self.steps += 1
        try:
            self._do()
        except Exception:
            _finish({"failed": traceback.format_exc()})
        if self.steps > MAX_STEPS:
            _finish({"failed": "the editor's window or its dialog did not appear"})

    def _do(self):
        if self.is_open and (dialogs := _dialogs()):
            dialog = dialogs[0]
            text = next(w for w in _descendants(dialog) if isinstance(w, wx.TextCtrl))
            text.SetValue(os.environ["FINGERTIP_NETLIST"])
            # Reading takes a second, during which no timer runs. A file that is not a netlist opens a message box that
            # waits for its button. Timers do run then, so this one ends the import.
            wx.CallLater(MESSAGE_BOX_MS, _finish, {"refused": "a message box"})
            _press(dialog, "Load and Test Netlist")
            tested = _messages(dialog)
            _press(dialog, "Update PCB")
            _finish({"tested": tested, "updated": _messages(dialog), "board": _board()})
        wx.CallLater(STEP_MS, self.step)
        frame = next((w for w in wx.GetTopLevelWindows() if w.GetName() == "PcbFrame" and w.IsShown()), None)
        if frame and not self.is_open and self.steps > 5:
            self.is_open = True
            for menu, _ in frame.GetMenuBar().GetMenus():
                if found := _menu_item(menu, "Netlist"):
                    event = wx.CommandEvent(wx.wxEVT_MENU, found[1].GetId())
                    event.SetEventObject(found[0])
                    found[0].ProcessEvent(event)  # returns when the dialog is closed
                    return
            raise RuntimeError("there is no File > Import > Netlist")


if "FINGERTIP_NETLIST" in os.environ:
    wx.CallAfter(wx.CallLater, STEP_MS, _Import().step)

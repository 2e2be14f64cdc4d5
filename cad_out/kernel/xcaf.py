"""What the writer and the reader of STEP files share: documents, labels and their names."""

from collections.abc import Callable
from typing import Any

from OCP.collections import Sequence_TDF_Label
from OCP.Interface import Interface_Static
from OCP.STEPCAFControl import STEPCAFControl_Controller
from OCP.STEPControl import STEPControl_Controller
from OCP.TCollection import TCollection_ExtendedString, TCollection_HAsciiString
from OCP.TDataStd import TDataStd_Name
from OCP.TDocStd import TDocStd_Document
from OCP.XCAFApp import XCAFApp_Application
from OCP.XCAFDoc import XCAFDoc_DocumentTool

from matstd.twin.errors import NotBuildable


def new_document() -> Any:
    """An empty document in millimetres."""
    document = TDocStd_Document(TCollection_ExtendedString("XmlOcaf"))
    XCAFApp_Application.GetApplication_s().NewDocument(
        TCollection_ExtendedString("MDTV-XCAF"), document
    )
    XCAFDoc_DocumentTool.SetLengthUnit_s(document, 0.001)
    return document


def settings(numbers: dict[str, int]) -> None:
    """Set the kernel's settings; those made before the controllers exist are dropped silently."""
    STEPCAFControl_Controller.Init_s()
    STEPControl_Controller.Init_s()
    for name, value in numbers.items():
        if not Interface_Static.SetIVal_s(name, value):
            raise NotBuildable(f"the CAD kernel does not know its setting {name}")


def set_name(label: Any, name: str) -> None:
    """Name a label."""
    TDataStd_Name.Set_s(label, TCollection_ExtendedString(name))


def name_of(label: Any) -> str:
    """Name of a label; empty where it has none."""
    name = TDataStd_Name()
    # Asking for an attribute that is not there crashes the process.
    if not label.IsAttribute(TDataStd_Name.GetID_s()):
        return ""
    label.FindAttribute(TDataStd_Name.GetID_s(), name)
    return str(name.Get().ToExtString())


def labels_of(fill: Callable[[Any], object]) -> list[Any]:
    """Labels that a call of the kernel lists; its sequences count from 1."""
    found = Sequence_TDF_Label()
    fill(found)
    return [found.Value(i) for i in range(1, found.Length() + 1)]


def text(value: str) -> Any:
    """A string of the kernel."""
    return TCollection_HAsciiString(value)

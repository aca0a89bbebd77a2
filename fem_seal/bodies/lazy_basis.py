"""scikit-fem's basis without what a contact does not ask for."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from skfem import CellBasis, Element, MeshTri
from skfem.element import DiscreteField

from fem_seal.arrays import FloatArray


class LazyBasis(CellBasis):
    """scikit-fem's basis, whose tables are made when somebody asks for them.

    Stiffness and stress take the shape functions of the reference triangle. Those of every triangle, as scikit-fem's
    forms need them, take ten times the time and memory of everything else here.

    Parameters
    ----------
    mesh : skfem.MeshTri
    elem : skfem.Element
    intorder : int
        Degree of the polynomials that are integrated exactly.
    """

    def __init__(self, mesh: MeshTri, elem: Element, intorder: int) -> None:
        # that of the base class alone: the one in between makes the tables
        super(CellBasis, self).__init__(
            mesh, elem, intorder=intorder, refdom=mesh.refdom, disable_doflocs=True
        )
        self.nelems = mesh.nelements

    @cached_property
    def basis(self) -> list[tuple[DiscreteField, ...]]:
        """Every shape function at the quadrature points."""
        return [self.elem.gbasis(self.mapping, self.X, number) for number in range(self.Nbfun)]

    @cached_property
    def dx(self) -> FloatArray:
        """Quadrature weights [m^2], shape (elements, points)."""
        return np.asarray(np.abs(self.mapping.detDF(self.X)) * self.W)

    @cached_property
    def doflocs(self) -> FloatArray:
        """Places of the dofs [m], shape (2, dofs)."""
        places = np.zeros((2, self.N))
        places[:, self.element_dofs] = np.swapaxes(self.mapping.F(self.elem.doflocs.T), 1, 2)
        return places

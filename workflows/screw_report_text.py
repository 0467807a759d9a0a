"""What the report of a screw pile says in words: captions, the method in plain language, limits."""

from __future__ import annotations

CAPTIONS = {
    "torque": """Torque and crowd force that the rig applies. The torque is positive in the sense
        that drives the pile down, the crowd force downward: where it is negative the rig has to
        hold the pile back. The weight of the pile in the ground helps the rig and is deducted.
        Dot: the rig stops; dotted: it lets go.""",
    "parts": """Where the torque comes from. Left: traction along the surface (adhesion or
        friction). Middle: normal traction, which turns the pile wherever the surface does not run
        round the axis: pressure ahead of the leading edge, behind the trailing edge, on the slope
        of the faces. Right: the last step before the rig lets go, with the closed forms of full
        slip.""",
    "work": """Where the work of the rig goes. What rig, slip, soil and weight exchange in each step
        must cancel; the right picture shows what is left over.""",
    "side": """Horizontal force and overturning moment of the soil on the pile. A plate of one turn
        is not symmetric about the axis, so they turn with the pile. The rig is taken to hold the
        pile upright.""",
    "vertical": """Vertical slice through the axis of the pile at the end. Left: displacement since
        the start, all three components; the arrows show its part in the plane, not to the scale of
        the picture. Right: change of mean pressure against the undisturbed ground, compression
        positive. Every place shows its nearest material point.""",
    "horizontal": """The same in the level plane through the middle of the lowest plate.""",
    "tractions": """The pile at the end as the soil feels it, mean of each facet: contact pressure
        (compression positive) and shear traction on its surface, from above and from below. Dark
        lines are the edges of the parts. Pressures beyond the ends of the scale, at the edges of
        the plates, have its last colours. On a screen the pile can be turned; the dots are material
        points behind the plane y = 0, coloured by the change of mean pressure.""",
    "animation": """The installation: displacement since the start and change of mean pressure in
        the vertical slice through the axis, and contact pressure on the pile.""",
    "newton": """Newton's method. Left: relative out-of-balance force of every step. Middle: order
        of the last iterations; 2 is quadratic, the line is at 1.8. Right: iterations, and how often
        a step was halved before it converged.""",
    "irregular": """What the scheme had to treat in each step: cells that are not full; material
        points that were split, merged or had left the mesh; the range of the volume ratio of all
        points (1: no change); and the shape of the worst cell (1 is regular).""",
    "far": """Force and moment found on the pile against those of supports far away and weight,
        three components each. They are the same in equilibrium, so the difference is an independent
        check of the solution: no step is accepted in which it exceeds the tolerance. The measure is
        the sum of the magnitudes of the forces on the pile, for the moment of each force times its
        distance from the axis.""",
}
"""Captions of the figures by name."""

FORMS = """
<p>The closed forms hold where soil slips along a part everywhere with the full shear limit
of the interface and does not leave it: 4π/3 τ (R³ − a³) per turn for both faces of a plate,
2πa² L τ cos β for shaft and rim, 2π/3 τ a³ for a flat tip, with tan β the advance over the way
round. A mesh of flat facets is a little smaller than the pile, so on a coarse mesh the computed
torque is some per cent below. For normal traction, and for the edges that cut through the soil,
there is no closed form.{friction}</p>
"""

FRICTION_NOTE = """ This interface has friction: its shear limit is taken from the computed mean
contact pressure of each part, so only the distribution of the traction is checked, not its
size."""

TIME_NOTE = """<p>Wall time of the parts of the method in the run that finished the installation;
what came before a restart is not in it.</p>"""

METHOD = """
<h3>How the figures were found</h3>
<p><b>Why not a usual finite-element mesh?</b> A screw pile cuts its way through the ground over
many times its own thickness. A mesh that sticks to the soil would be torn to pieces. Here the soil
is followed by <i>material points</i>: small parcels that keep their mass and carry stress and
strength wherever they go. This is the material point method (MPM).</p>
<p><b>One step.</b> The pile turns and sinks by a fraction of a cell. Around it lies a
<i>background mesh</i> of tetrahedra that fits its surface exactly and moves with it like a sleeve;
further out it tapers to rest. On this mesh the displacement is found at which soil, interface
and pile are in equilibrium, by Newton's method: guess, look at the forces out of balance,
correct. The parcels take that displacement. Then the mesh is set to its regular shape again,
wound back once it has turned too far, and only the parcels remember what happened. Because the
mesh never keeps the deformation, that may be as large as it likes. A step counts only if the
out-of-balance force has vanished to the tolerance of the case; otherwise it is halved and tried
again.</p>
<p><b>Pile and soil</b> touch in an interface on the surface of the pile: soil may slip along it
once the shear traction reaches adhesion or friction. Torque and crowd force are the sums of these
tractions; nothing else acts on the pile.</p>
<p><b>Three independent checks</b> accompany every step: the forces on the pile must equal those at
the far supports, the work of the rig must equal what slip, soil and weight take up, and the
tangential torque of each part can be compared with its closed form.</p>
"""

LIMITS = """
<h3>What limits the answer</h3>
<ul>
<li>The pile starts wished in place at its first depth, in ground that nothing has disturbed. Until
it has moved by about the thickness of a plate, torque and crowd force are those of a start, not of
an installation.</li>
<li>The pile is rigid and held upright by the rig; it follows the programme of the case exactly:
its motions, or its loads.</li>
<li>No rate effects and no consolidation: set-up after the installation and softening by cyclic
loading are not in the model, remoulding only if the soil law of the case has it.</li>
<li>One mesh gives one answer. The edges of the plates govern the error: the pressure ahead of a
blunt leading edge changes most when the mesh is refined. Run the case on a finer mesh and with
smaller steps before the torque is used in a design.</li>
<li>Unless the case gives friction or a tensile strength of the interface, soil cannot part from the
pile: suction acts above a plate and behind its trailing edge.</li>
<li>The adhesion is that of the undisturbed ground at each level.</li>
<li>Wall and base of the box are supported at a finite distance; a wider box may give other
figures.</li>
<li>Pressures of single material points scatter more than forces, which are sums over many.</li>
</ul>
"""

SERVICE_CAPTIONS = {
    "handed_off": """Change of mean pressure against undisturbed ground in the vertical plane
        through the axis, in the finite elements. Left: the installed state after the hand-over, in
        equilibrium. Right: the pile wished in place, at the end of its last programme. Each pixel
        shows its nearest integration point.""",
    "shaft": """Traction between shaft and soil, mean around the shaft, level by level: as the
        installation left it, and after the hand-over.""",
    "curves": """Load of the structure on the head against its displacement, for the whole pile:
        the installed pile and the same pile wished in place, in the same programme. Dot: capacity
        at a displacement of 0.1 diameters of the largest plate. Cross: where initial and final
        tangent meet.""",
    "along": """what the pile feels along its axis at the end, in the direction of the load:
        deflection, force p of the soil per length against the load, and of a deformable pile shear
        force and bending moment from the stress in its sections. Right: p over the deflection y at
        some levels, darker with the depth; a bonded pile has no p. All are changes since the start
        of the programme.""",
    "cycles": """what the cycles leave behind. Tilt of the pile in the direction of the load, and
        displacement of the point of load, since the start of the packet: at the mean load at the
        end of each cycle (dots), and at the peaks of the load (dashed).""",
    "continuity": """Continuity: the pile is moved on in the finite elements as if the rig had not
        stopped. Torque and force should take up those of the installation, after the few
        millimetres in which soil and interface are strained again.""",
}

SERVICE_LIMITS = """
<h3>What limits the results in service</h3>
<ul>
<li>Strains in service are small: the mesh does not follow the pile.</li>
<li>The ratio installed over wished in place is a prediction. Its range holds the error of the
finite elements and of the transfer; for that of the installation run the whole case with a finer
<code>[background_mesh]</code>.</li>
<li>The pile is rigid; with <code>[service.pile]</code> it is elastic, and starts without other
stress than what balances the ground that was handed over.</li>
<li>In compression and uplift the head is guided: it neither turns nor moves sideways.</li>
</ul>
"""

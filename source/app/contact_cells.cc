#include <slipstick/app/contact_cells.h>
#include <slipstick/base/box_tree.h>
#include <slipstick/base/gather.h>

#include <deal.II/base/mpi.h>

#include <boost/serialization/array.hpp>
#include <boost/serialization/utility.hpp>
#include <boost/serialization/vector.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace slipstick::app
{
  namespace
  {
    // Master faces may be this much longer than slave faces: less than the factor 2 or 3 of one refinement.
    constexpr double largest_ratio = 1.6;
    // A face is at a contact node if its centre is closer than this fraction of its diameter (0.5 along an edge).
    constexpr double nearby = 0.6;

    /// A face on the outline of a body.
    template <int dim>
    struct OutlineFace
    {
      unsigned int            body = 0;
      std::array<double, dim> center{};
      double                  size     = 0; // diameter [mm]
      double                  division = 1; // of its edges by a refinement of its cell
      mesh::CellKey           cell;

      template <class Archive>
      void serialize(Archive &archive, const unsigned int /*version*/)
      {
        archive &body &center &size &division &cell;
      }

      dealii::Point<dim> place() const
      {
        dealii::Point<dim> x;
        for (unsigned int d = 0; d < dim; ++d)
          x[d] = center[d];
        return x;
      }

      bool is_at(const contact::ContactNode &node) const
      {
        double square = 0;
        for (unsigned int d = 0; d < dim; ++d)
          square += (center[d] - node.position[d]) * (center[d] - node.position[d]);
        return std::sqrt(square) <= nearby * size + std::abs(node.initial_gap);
      }
    };

    /// Of the bodies in @p bodies, of all ranks on rank 0. Collective.
    template <int dim>
    std::vector<OutlineFace<dim>> outline_faces(const mesh::Mesh<dim> &mesh, const std::vector<bool> &bodies)
    {
      std::vector<OutlineFace<dim>> own;
      for (const auto &subdomain : mesh.subdomains)
        if (bodies[subdomain->body])
          for (const auto &cell : subdomain->triangulation.active_cell_iterators())
            for (const unsigned int f : cell->face_indices())
              if (const auto face = cell->face(f); mesh::is_on_outline(face))
                {
                  std::vector<mesh::GlobalVertex> vertices;
                  for (const unsigned int v : cell->vertex_indices())
                    vertices.push_back(subdomain->global_vertices[cell->vertex_index(v)]);
                  OutlineFace<dim> one;
                  one.body = subdomain->body;
                  for (unsigned int d = 0; d < dim; ++d)
                    one.center[d] = face->center()[d];
                  one.size     = face->diameter();
                  one.division = cell->reference_cell().is_hyper_cube() ? 3 : 2;
                  one.cell     = mesh::cell_key(std::move(vertices));
                  own.push_back(std::move(one));
                }
      std::vector<OutlineFace<dim>> all;
      for (const auto &part : gather(mesh.comm, own))
        all.insert(all.end(), part.begin(), part.end());
      return all;
    }

    /// Finds the faces at contact nodes.
    template <int dim>
    class FacesAtNodes
    {
    public:
      /// Keeps a reference to @p faces_.
      explicit FacesAtNodes(const std::vector<OutlineFace<dim>> &faces_)
        : faces(faces_)
        , tree(centers(faces))
      {
        for (const auto &face : faces)
          reach = std::max(reach, nearby * face.size);
      }

      /// Calls f(face) for those of the two bodies of the pair.
      template <class F>
      void for_each(const contact::ContactNode &node, const scene::ContactPair<dim> &pair, const F &f) const
      {
        dealii::Point<dim> x;
        for (unsigned int d = 0; d < dim; ++d)
          x[d] = node.position[d];
        const auto around = BoxTree<dim>::widened(BoxTree<dim>::box_around({x}), reach + std::abs(node.initial_gap));
        for (const unsigned int k : tree.near(around))
          if (const auto &face = faces[k];
              (face.body == pair.slave.body || (pair.master && face.body == pair.master->body)) && face.is_at(node))
            f(face);
      }

    private:
      static std::vector<typename BoxTree<dim>::Box> centers(const std::vector<OutlineFace<dim>> &faces)
      {
        std::vector<typename BoxTree<dim>::Box> boxes;
        for (const auto &face : faces)
          boxes.push_back(BoxTree<dim>::box_around({face.place()}));
        return boxes;
      }

      const std::vector<OutlineFace<dim>> &faces;
      const BoxTree<dim>                   tree;
      double                               reach = 0; // within which faces are at a node without gap
    };

    bool is_goal(const std::string &pair, const std::vector<std::string> &goals)
    {
      return std::any_of(goals.begin(), goals.end(), [&pair](const std::string &goal) {
        return goal == pair + ".max_pressure" || goal == pair + ".pressure_norm" || goal == pair + ".traction_norm";
      });
    }
  } // namespace

  template <int dim>
  std::size_t mark_coarse_masters(const scene::Scene<dim>                 &scene,
                                  const mesh::Mesh<dim>                   &mesh,
                                  const std::vector<contact::ContactNode> &nodes,
                                  const std::vector<std::string>          &goals,
                                  mesh::Refinement                        &refinement)
  {
    std::vector<bool> bodies(scene.bodies.size(), false), pairs(scene.contacts.size(), false);
    for (unsigned int k = 0; k < pairs.size(); ++k)
      if (const auto &pair = scene.contacts[k]; pair.master && !pair.law.is_bonded && is_goal(pair.name, goals))
        pairs[k] = bodies[pair.slave.body] = bodies[pair.master->body] = true;
    if (std::find(pairs.begin(), pairs.end(), true) == pairs.end())
      return 0;
    const auto  faces    = outline_faces(mesh, bodies);
    std::size_t n_marked = 0;
    if (dealii::Utilities::MPI::this_mpi_process(mesh.comm) == 0)
      {
        const auto size = [&refinement](const OutlineFace<dim> &face) { // on the next mesh
          const auto &[body, path] = refinement.cells.at(face.cell);
          return face.size / (refinement.refined[body].count(path) ? face.division : 1.);
        };
        const FacesAtNodes<dim> at_nodes(faces);
        for (const auto &node : nodes)
          {
            if (!node.is_closed || !pairs[node.pair])
              continue;
            const auto                           &pair  = scene.contacts[node.pair];
            double                                slave = std::numeric_limits<double>::infinity();
            std::vector<const OutlineFace<dim> *> masters;
            at_nodes.for_each(node, pair, [&](const OutlineFace<dim> &face) {
              if (face.body == pair.slave.body)
                slave = std::min(slave, size(face));
              if (face.body == pair.master->body)
                masters.push_back(&face);
            });
            for (const auto *face : masters)
              if (size(*face) > largest_ratio * slave)
                {
                  const auto &[body, path] = refinement.cells.at(face->cell);
                  n_marked += refinement.refined[body].insert(path).second;
                }
          }
      }
    return dealii::Utilities::MPI::broadcast(mesh.comm, n_marked);
  }

  template <int dim>
  std::size_t mark_contact_zones(const scene::Scene<dim>                 &scene,
                                 const mesh::Mesh<dim>                   &mesh,
                                 const std::vector<contact::ContactNode> &nodes,
                                 const std::vector<unsigned int>         &pairs,
                                 mesh::Refinement                        &refinement)
  {
    std::vector<bool> bodies(scene.bodies.size(), false);
    for (const unsigned int k : pairs)
      {
        bodies[scene.contacts[k].slave.body] = true;
        if (scene.contacts[k].master)
          bodies[scene.contacts[k].master->body] = true;
      }
    const auto  faces    = outline_faces(mesh, bodies);
    std::size_t n_marked = 0;
    if (dealii::Utilities::MPI::this_mpi_process(mesh.comm) == 0)
      {
        const FacesAtNodes<dim> at_nodes(faces);
        for (const auto &node : nodes)
          if (node.is_closed && std::find(pairs.begin(), pairs.end(), node.pair) != pairs.end())
            at_nodes.for_each(node, scene.contacts[node.pair], [&](const OutlineFace<dim> &face) {
              const auto &[body, path] = refinement.cells.at(face.cell);
              n_marked += refinement.refined[body].insert(path).second;
            });
      }
    return dealii::Utilities::MPI::broadcast(mesh.comm, n_marked);
  }

  template std::size_t mark_contact_zones(const scene::Scene<2> &,
                                          const mesh::Mesh<2> &,
                                          const std::vector<contact::ContactNode> &,
                                          const std::vector<unsigned int> &,
                                          mesh::Refinement &);
  template std::size_t mark_contact_zones(const scene::Scene<3> &,
                                          const mesh::Mesh<3> &,
                                          const std::vector<contact::ContactNode> &,
                                          const std::vector<unsigned int> &,
                                          mesh::Refinement &);
  template std::size_t mark_coarse_masters(const scene::Scene<2> &,
                                           const mesh::Mesh<2> &,
                                           const std::vector<contact::ContactNode> &,
                                           const std::vector<std::string> &,
                                           mesh::Refinement &);
  template std::size_t mark_coarse_masters(const scene::Scene<3> &,
                                           const mesh::Mesh<3> &,
                                           const std::vector<contact::ContactNode> &,
                                           const std::vector<std::string> &,
                                           mesh::Refinement &);
} // namespace slipstick::app

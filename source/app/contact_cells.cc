#include <slipstick/app/contact_cells.h>
#include <slipstick/base/box_tree.h>
#include <slipstick/base/gather.h>
#include <slipstick/base/log.h>
#include <slipstick/contact/contact_nodes.h>

#include <deal.II/base/mpi.h>

#include <boost/serialization/array.hpp>
#include <boost/serialization/map.hpp>
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
    // Ratios of moduli and edges above which a slave is said to be much stiffer, and finer, than its master.
    constexpr double much_stiffer = 10, much_finer = 1.2;
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
      mesh::CellKey           cell{};

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
    /// @param is_adaptive whether cells have keys: meshes that are refined consist of triangles, quadrilaterals and
    /// tetrahedra.
    template <int dim>
    std::vector<OutlineFace<dim>> outline_faces(const mesh::Mesh<dim>   &mesh,
                                                const std::vector<bool> &bodies,
                                                const bool               is_adaptive)
    {
      std::vector<OutlineFace<dim>> own;
      for (const auto &subdomain : mesh.subdomains)
        if (bodies[subdomain->body])
          for (const auto &cell : subdomain->triangulation.active_cell_iterators())
            for (const unsigned int f : cell->face_indices())
              if (const auto face = cell->face(f); mesh::is_on_outline(face))
                {
                  OutlineFace<dim> one;
                  one.body = subdomain->body;
                  for (unsigned int d = 0; d < dim; ++d)
                    one.center[d] = face->center()[d];
                  one.size     = face->diameter();
                  one.division = cell->reference_cell().is_hyper_cube() ? 3 : 2;
                  if (is_adaptive)
                    {
                      std::vector<mesh::GlobalVertex> vertices;
                      for (const unsigned int v : cell->vertex_indices())
                        vertices.push_back(subdomain->global_vertices[cell->vertex_index(v)]);
                      one.cell = mesh::cell_key(std::move(vertices));
                    }
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

      /// Those of the two bodies of the pair.
      std::vector<const OutlineFace<dim> *> at(const contact::ContactNode    &node,
                                               const scene::ContactPair<dim> &pair) const
      {
        std::vector<const OutlineFace<dim> *> found;
        dealii::Point<dim>                    x;
        for (unsigned int d = 0; d < dim; ++d)
          x[d] = node.position[d];
        const auto around = BoxTree<dim>::widened(BoxTree<dim>::box_around({x}), reach + std::abs(node.initial_gap));
        for (const unsigned int k : tree.near(around))
          if (const auto &face = faces[k];
              (face.body == pair.slave.body || (pair.master && face.body == pair.master->body)) && face.is_at(node))
            found.push_back(&face);
        return found;
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
    const auto  faces    = outline_faces(mesh, bodies, true);
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
            for (const auto *face : at_nodes.at(node, pair))
              {
                if (face->body == pair.slave.body)
                  slave = std::min(slave, size(*face));
                if (face->body == pair.master->body)
                  masters.push_back(face);
              }
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
  std::map<std::string, std::string> finer_slave_warnings(const scene::Scene<dim>  &scene,
                                                          const mesh::Mesh<dim>    &mesh,
                                                          const tfeti::Constraints &constraints)
  {
    const auto modulus = [&scene](const unsigned int body) {
      return scene.materials[scene.bodies[body].material].young_modulus;
    };
    std::vector<bool> bodies(scene.bodies.size(), false), pairs(scene.contacts.size(), false);
    for (unsigned int k = 0; k < pairs.size(); ++k)
      if (const auto &pair = scene.contacts[k];
          pair.master && !pair.law.is_bonded && modulus(pair.slave.body) > much_stiffer * modulus(pair.master->body))
        pairs[k] = bodies[pair.slave.body] = bodies[pair.master->body] = true;
    std::map<std::string, std::string> texts;
    if (std::find(pairs.begin(), pairs.end(), true) == pairs.end())
      return texts;
    const auto                        faces = outline_faces(mesh, bodies, false);
    std::vector<contact::ContactNode> own;
    for (const auto &point : constraints.contact_points)
      if (pairs[point.pair])
        own.push_back(contact::node_at(point));
    const auto nodes = gather(mesh.comm, own);
    if (dealii::Utilities::MPI::this_mpi_process(mesh.comm) == 0)
      {
        struct Edges
        {
          unsigned int n_nodes = 0, n_finer = 0; // that may touch
          double       slave = 0, master = 0;    // sums over the finer ones [mm]
        };
        std::vector<Edges>      edges(pairs.size());
        const FacesAtNodes<dim> at_nodes(faces);
        for (const auto &of_rank : nodes)
          for (const auto &node : of_rank)
            {
              double slave = 0, master = 0;
              for (const auto *face : at_nodes.at(node, scene.contacts[node.pair]))
                {
                  double &size = face->body == scene.contacts[node.pair].slave.body ? slave : master;
                  size         = std::max(size, face->size);
                }
              if (slave == 0 || master == 0 || node.initial_gap > slave)
                continue;
              auto &of_pair = edges[node.pair];
              ++of_pair.n_nodes;
              if (master <= much_finer * slave)
                continue;
              ++of_pair.n_finer;
              of_pair.slave += slave;
              of_pair.master += master;
            }
        for (unsigned int k = 0; k < pairs.size(); ++k)
          if (const auto &of_pair = edges[k]; 2 * of_pair.n_finer > of_pair.n_nodes)
            texts["finer " + scene.contacts[k].name] = format(
              "Contact %s: its slave is stiffer (%.3g and %.3g MPa) and finer (edges of %.3g and %.3g mm) than its "
              "master, so that nodal pressures and tractions alternate and the solver needs many steps; exchange "
              "Slave and Master, or refine the master",
              scene.contacts[k].name.c_str(),
              modulus(scene.contacts[k].slave.body),
              modulus(scene.contacts[k].master->body),
              of_pair.slave / of_pair.n_finer,
              of_pair.master / of_pair.n_finer);
      }
    return dealii::Utilities::MPI::broadcast(mesh.comm, texts);
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
    const auto  faces    = outline_faces(mesh, bodies, true);
    std::size_t n_marked = 0;
    if (dealii::Utilities::MPI::this_mpi_process(mesh.comm) == 0)
      {
        const FacesAtNodes<dim> at_nodes(faces);
        for (const auto &node : nodes)
          if (node.is_closed && std::find(pairs.begin(), pairs.end(), node.pair) != pairs.end())
            for (const auto *face : at_nodes.at(node, scene.contacts[node.pair]))
              {
                const auto &[body, path] = refinement.cells.at(face->cell);
                n_marked += refinement.refined[body].insert(path).second;
              }
      }
    return dealii::Utilities::MPI::broadcast(mesh.comm, n_marked);
  }

  template std::map<std::string, std::string> finer_slave_warnings(const scene::Scene<2> &,
                                                                   const mesh::Mesh<2> &,
                                                                   const tfeti::Constraints &);
  template std::map<std::string, std::string> finer_slave_warnings(const scene::Scene<3> &,
                                                                   const mesh::Mesh<3> &,
                                                                   const tfeti::Constraints &);
  template std::size_t                        mark_contact_zones(const scene::Scene<2> &,
                                                                 const mesh::Mesh<2> &,
                                                                 const std::vector<contact::ContactNode> &,
                                                                 const std::vector<unsigned int> &,
                                                                 mesh::Refinement &);
  template std::size_t                        mark_contact_zones(const scene::Scene<3> &,
                                                                 const mesh::Mesh<3> &,
                                                                 const std::vector<contact::ContactNode> &,
                                                                 const std::vector<unsigned int> &,
                                                                 mesh::Refinement &);
  template std::size_t                        mark_coarse_masters(const scene::Scene<2> &,
                                                                  const mesh::Mesh<2> &,
                                                                  const std::vector<contact::ContactNode> &,
                                                                  const std::vector<std::string> &,
                                                                  mesh::Refinement &);
  template std::size_t                        mark_coarse_masters(const scene::Scene<3> &,
                                                                  const mesh::Mesh<3> &,
                                                                  const std::vector<contact::ContactNode> &,
                                                                  const std::vector<std::string> &,
                                                                  mesh::Refinement &);
} // namespace slipstick::app
